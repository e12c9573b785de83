#include "algorithms/scene/volumes/volume_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>

#include <fmt/format.h>
#include <zlib.h>

#include "algorithms/scene/volumes/volume_formats.hpp"
#include "gl/error.hpp"

namespace pellucid {

namespace fs = std::filesystem;

// ---- shared by the formats ----

void fail_volume(const fs::path& path, std::string_view reason) {
  throw InputError(fmt::format("cannot read volume '{}': {}", path.string(), reason));
}

void check_header(const fs::path& path, const VolumeHeader& header, std::uintmax_t bytes) {
  const auto& [size, spacing, components] = header;
  const std::string shown = fmt::format("{} x {} x {} voxels", size.x, size.y, size.z);
  for (int c = 0; c < 3; ++c) {
    if (size[c] < 1) fail_volume(path, fmt::format("{}; every axis needs at least one", shown));
    if (size[c] > kMaxVoxelsPerAxis) {
      fail_volume(path, fmt::format("{}; at most {} along an axis are read", shown, kMaxVoxelsPerAxis));
    }
    if (!(std::isfinite(spacing[c]) && spacing[c] > 0)) {
      fail_volume(path, fmt::format("a voxel spacing of {} along {}; it must be above 0", spacing[c], "xyz"[c]));
    }
  }
  if (header.count() > kMaxVoxels) fail_volume(path, fmt::format("{}; at most 2^30 are read", shown));
  if (components != 1) fail_volume(path, fmt::format("{} values a voxel; one is needed", components));
  constexpr std::uint64_t kDensestPacking = 8192;  // voxels a byte; beyond any of the formats' compressions
  if (header.count() / kDensestPacking > bytes) {
    fail_volume(path, fmt::format("its header claims {}, more than {} bytes can hold", shown, bytes));
  }
}

double header_number(const fs::path& path, std::string_view field, std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    fail_volume(path, fmt::format("'{}' is no number for {} in its header", text, field));
  }
  return value;
}

int header_size(const fs::path& path, std::string_view field, std::string_view text) {
  const double value = header_number(path, field, text);
  if (!(value >= 0 && value <= std::numeric_limits<int>::max() && value == std::floor(value))) {
    fail_volume(path, fmt::format("'{}' is no size for {} in its header", text, field));
  }
  return static_cast<int>(value);
}

namespace {

template <class T>
float value_from(const char* bytes, bool swapped) {
  std::array<char, sizeof(T)> ordered;
  std::memcpy(ordered.data(), bytes, sizeof(T));
  if (swapped) std::reverse(ordered.begin(), ordered.end());
  T value;
  std::memcpy(&value, ordered.data(), sizeof(T));
  return static_cast<float>(value);
}

template <class T>
VoxelType voxel_of() {
  return {sizeof(T), value_from<T>};
}

}  // namespace

VoxelType voxel_type(VoxelKind kind, int bits) {
  switch (kind) {
    case VoxelKind::floating:
      return bits == 32 ? voxel_of<float>() : bits == 64 ? voxel_of<double>() : VoxelType{};
    case VoxelKind::unsigned_integer:
      return bits == 8    ? voxel_of<std::uint8_t>()
             : bits == 16 ? voxel_of<std::uint16_t>()
             : bits == 32 ? voxel_of<std::uint32_t>()
             : bits == 64 ? voxel_of<std::uint64_t>()
                          : VoxelType{};
    case VoxelKind::signed_integer:
      return bits == 8    ? voxel_of<std::int8_t>()
             : bits == 16 ? voxel_of<std::int16_t>()
             : bits == 32 ? voxel_of<std::int32_t>()
             : bits == 64 ? voxel_of<std::int64_t>()
                          : VoxelType{};
  }
  return {};
}

std::vector<float> decode_voxels(std::string_view raw, VoxelType type, bool swapped) {
  std::vector<float> values(raw.size() / type.bytes);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = type.value(raw.data() + i * type.bytes, swapped);
  return values;
}

std::string read_behind(const fs::path& path, std::uintmax_t offset) {
  std::ifstream file(path, std::ios::binary);
  std::string content(fs::file_size(path) - offset, '\0');
  file.seekg(static_cast<std::streamoff>(offset));
  if (!file.read(content.data(), static_cast<std::streamsize>(content.size()))) fail_volume(path, "it cannot be read");
  return content;
}

void unpack(const fs::path& path, std::string_view packed, const std::function<void(std::string_view)>& take_piece) {
  constexpr int kAnyFormat = 15 + 32;  // the widest window, zlib's or gzip's header
  z_stream stream{};
  if (inflateInit2(&stream, kAnyFormat) != Z_OK) throw RuntimeError("zlib cannot be initialised");
  struct End {
    z_stream& stream;
    ~End() { inflateEnd(&stream); }
  } end{stream};
  std::string piece(1 << 18, '\0');
  std::size_t taken = 0;
  int state = Z_OK;
  while (state != Z_STREAM_END) {
    if (stream.avail_in == 0) {
      // zlib counts in 32 bits.
      const std::size_t some = std::min<std::size_t>(packed.size() - taken, std::size_t{1} << 30);
      if (some == 0) fail_volume(path, "its packed voxels end too soon");
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + taken));
      stream.avail_in = static_cast<uInt>(some);
      taken += some;
    }
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = static_cast<uInt>(piece.size());
    state = inflate(&stream, Z_NO_FLUSH);
    if (state != Z_OK && state != Z_STREAM_END && state != Z_BUF_ERROR) {
      fail_volume(path, "its packed voxels are damaged");
    }
    take_piece(std::string_view(piece).substr(0, piece.size() - stream.avail_out));
  }
}

// ---- any format ----

namespace {

void check_finite(const fs::path& path, const VolumeFile& volume) {
  const auto wrong =
      std::find_if(volume.values.begin(), volume.values.end(), [](float v) { return !std::isfinite(v); });
  if (wrong == volume.values.end()) return;
  const auto index = wrong - volume.values.begin();
  const std::int64_t width = volume.size.x;
  const std::int64_t height = volume.size.y;
  fail_volume(path, fmt::format("the value at voxel ({}, {}, {}) is {}", index % width, index / width % height,
                                index / (width * height), *wrong));
}

VolumeFile load(const fs::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".vti") return load_vti(path);
  if (extension == ".mhd" || extension == ".mha") return load_meta_image(path);
  if (extension == ".nrrd" || extension == ".nhdr") return load_nrrd(path);
  if (extension == ".inr") return load_inr(path);
  fail_volume(path, fmt::format("'{}' is none of .vti, .mhd, .mha, .nrrd, .nhdr and .inr", extension));
}

}  // namespace

VolumeFile load_volume_file(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) fail_volume(path, "there is no such file");
  if (!std::ifstream(path).is_open()) fail_volume(path, std::strerror(errno));
  if (fs::file_size(path) == 0) fail_volume(path, "the file is empty");
  VolumeFile volume = load(path);
  volume.files.insert(volume.files.begin(), path);
  check_finite(path, volume);
  return volume;
}

glm::dvec2 normalise(VolumeFile& volume, const std::optional<glm::dvec2>& range) {
  glm::dvec2 used(0.0);
  if (range) {
    used = *range;
  } else {
    const auto [low, high] = std::minmax_element(volume.values.begin(), volume.values.end());
    used = {static_cast<double>(*low), static_cast<double>(*high)};
    if (!(used.x < used.y)) {
      throw InputError(fmt::format("its values are all {}; state what shall be 0 and 1: range = [low, high]", used.x));
    }
  }
  const double scale = 1 / (used.y - used.x);
  for (float& value : volume.values)
    value = static_cast<float>(std::clamp((static_cast<double>(value) - used.x) * scale, 0.0, 1.0));
  return used;
}

}  // namespace pellucid
