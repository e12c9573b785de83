#include "algorithms/scene/volumes/volume_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "algorithms/scene/volumes/volume_formats.hpp"
#include "gl/error.hpp"

namespace pellucid {

namespace fs = std::filesystem;

namespace {

template <class T>
double value_from(const char* bytes, bool swapped) {
  std::array<char, sizeof(T)> ordered;
  std::memcpy(ordered.data(), bytes, sizeof(T));
  if (swapped) std::reverse(ordered.begin(), ordered.end());
  T value;
  std::memcpy(&value, ordered.data(), sizeof(T));
  return static_cast<double>(value);
}

template <class T>
bool store_as(double value, char* bytes) {
  using Limits = std::numeric_limits<T>;
  if constexpr (Limits::is_integer) {
    // The highest number plus one is a power of two and, unlike the highest of 64 bits, exact.
    if (!(value >= static_cast<double>(Limits::min()) && value < static_cast<double>(Limits::max()) + 1.0 &&
          value == std::floor(value)))
      return false;
  } else if (std::isfinite(value) && std::abs(value) > static_cast<double>(Limits::max())) {
    return false;
  }
  const T stored = static_cast<T>(value);
  std::memcpy(bytes, &stored, sizeof stored);
  return true;
}

template <class T>
VoxelType voxel_of() {
  return {sizeof(T), value_from<T>, store_as<T>};
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

namespace {

/// Finds the range of the values; each is finite.
void measure(const fs::path& path, VolumeFile& volume) {
  glm::dvec2 range(std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < volume.voxels.size(); ++i) {
    const double value = volume.voxels[i];
    if (!std::isfinite(value)) {
      const auto width = static_cast<std::size_t>(volume.size.x), height = static_cast<std::size_t>(volume.size.y);
      fail_volume(path, fmt::format("the value at voxel ({}, {}, {}) is {}", i % width, i / width % height,
                                    i / (width * height), value));
    }
    range = {std::min(range.x, value), std::max(range.y, value)};
  }
  volume.value_range = range;
}

VolumeFile load(const fs::path& path) {
  const std::string shown = path.extension().string();
  std::string extension = shown;
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".vti") return load_vti(path);
  if (extension == ".mhd" || extension == ".mha") return load_meta_image(path);
  if (extension == ".nrrd" || extension == ".nhdr") return load_nrrd(path);
  if (extension == ".inr") return load_inr(path);
  fail_volume(path, fmt::format("'{}' is none of .vti, .mhd, .mha, .nrrd, .nhdr and .inr", shown));
}

}  // namespace

VolumeFile load_volume_file(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) fail_volume(path, "there is no such file");
  if (!std::ifstream(path).is_open()) fail_volume(path, std::strerror(errno));
  if (fs::file_size(path) == 0) fail_volume(path, "the file is empty");
  VolumeFile volume = load(path);
  volume.files.insert(volume.files.begin(), path);
  measure(path, volume);
  return volume;
}

Densities normalise(const VolumeFile& volume, const std::optional<glm::dvec2>& range) {
  const glm::dvec2 used = range.value_or(volume.value_range);
  if (!(used.x < used.y)) {
    throw InputError(fmt::format("its values are all {}; state what shall be 0 and 1: range = [low, high]", used.x));
  }
  Densities out{std::vector<float>(volume.voxels.size()), used};
  // The difference of two doubles may be too large for one; that of their halves never is.
  const double unit = std::isfinite(used.y - used.x) ? 1.0 : 0.5;
  const double low = used.x * unit, extent = used.y * unit - low;
  for (std::size_t i = 0; i < out.values.size(); ++i)
    out.values[i] =
        static_cast<float>(std::clamp((std::clamp(volume.voxels[i], used.x, used.y) * unit - low) / extent, 0.0, 1.0));
  return out;
}

}  // namespace pellucid
