#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <zlib.h>

#include "algorithms/scene/volumes/volume_formats.hpp"
#include "gl/error.hpp"

/// The formats share this: numbers of headers, and the bytes behind them.
namespace pellucid {

namespace fs = std::filesystem;

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
  std::string_view digits = text;
  if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) {
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

fs::path data_file(const fs::path& path, const std::string& name) {
  const fs::path file = path.parent_path() / name;
  std::error_code error;
  if (fs::is_regular_file(file, error)) return file;
  if (name.starts_with("LIST") || name.find('%') != std::string::npos)
    fail_volume(path, "its voxels lie in several files; one is read");
  fail_volume(path, fmt::format("its data file '{}' is missing", file.string()));
}

namespace {

std::string read_behind(const fs::path& path, const fs::path& shown, std::uintmax_t offset) {
  std::ifstream file(path, std::ios::binary);
  std::string content(fs::file_size(path) - offset, '\0');
  file.seekg(static_cast<std::streamoff>(offset));
  if (!file.read(content.data(), static_cast<std::streamsize>(content.size()))) fail_volume(shown, "it cannot be read");
  return content;
}

[[noreturn]] void fail_bytes(const fs::path& path, std::uintmax_t found, std::size_t promised) {
  fail_volume(path, fmt::format("{} bytes of voxels where its header promises {}", found, promised));
}

/// Unpacks zlib's or gzip's format: for the latter RFC 1952 allows several members, one behind the other.
class Unpacker {
 public:
  Unpacker(const fs::path& path, std::string packed) : path_(path), packed_(std::move(packed)) {}

  /// Everything; throws when it is not `promised` bytes.
  std::string unpack(std::size_t promised) {
    constexpr std::uint64_t kDensest = 1032;  // what deflate can do at most
    if (promised / kDensest > packed_.size()) fail_volume(path_, "its packed voxels end too soon");
    std::string out;
    out.reserve(promised);
    do {
      member(out, promised);
    } while (another_member());
    if (out.size() != promised) fail_bytes(path_, out.size(), promised);
    return out;
  }

 private:
  void member(std::string& out, std::size_t promised) {
    constexpr int kAnyFormat = 15 + 32;  // the widest window, zlib's or gzip's header
    z_stream stream{};
    if (inflateInit2(&stream, kAnyFormat) != Z_OK) throw RuntimeError("zlib cannot be initialised");
    struct End {
      z_stream& stream;
      ~End() { inflateEnd(&stream); }
    } end{stream};
    std::string piece(1 << 18, '\0');
    int state = Z_OK;
    while (state != Z_STREAM_END) {
      if (stream.avail_in == 0) {
        // zlib counts in 32 bits.
        const std::size_t some = std::min<std::size_t>(packed_.size() - taken_, std::size_t{1} << 30);
        if (some == 0) fail_volume(path_, "its packed voxels end too soon");
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed_.data() + taken_));
        stream.avail_in = static_cast<uInt>(some);
        taken_ += some;
      }
      stream.next_out = reinterpret_cast<Bytef*>(piece.data());
      stream.avail_out = static_cast<uInt>(piece.size());
      state = inflate(&stream, Z_NO_FLUSH);
      if (state != Z_OK && state != Z_STREAM_END && state != Z_BUF_ERROR)
        fail_volume(path_, "its packed voxels are damaged");
      out.append(piece, 0, piece.size() - stream.avail_out);
      if (out.size() > promised) fail_bytes(path_, out.size(), promised);
    }
    taken_ -= stream.avail_in;
  }

  /// Zeros that fill up a block may follow the last.
  bool another_member() const {
    const std::string_view rest = std::string_view(packed_).substr(taken_);
    if (rest.find_first_not_of('\0') == std::string_view::npos) return false;
    if (!rest.starts_with("\x1f\x8b")) fail_volume(path_, "something follows its packed voxels");
    return true;
  }

  const fs::path& path_;
  std::string packed_;
  std::size_t taken_ = 0;
};

}  // namespace

VolumeFile read_voxels(const fs::path& path, const VolumeHeader& header, const VoxelBytes& place) {
  const std::uintmax_t all = fs::file_size(place.file);
  std::uintmax_t offset = std::min(place.offset, all);
  check_header(path, header, all - offset);
  const std::size_t promised = header.count() * place.type.bytes;
  auto raw = std::make_shared<std::string>();
  switch (const std::uintmax_t found = all - offset; place.coding) {
    case VoxelCoding::raw:
      if (found < promised || (found > promised && !place.from_end && !place.may_follow))
        fail_bytes(path, found, promised);
      if (place.from_end) offset = all - promised;
      *raw = read_behind(place.file, path, offset);
      break;
    case VoxelCoding::packed:
      *raw = Unpacker(path, read_behind(place.file, path, offset)).unpack(promised);
      break;
    case VoxelCoding::numbers:
      *raw = voxels_of_numbers(path, read_behind(place.file, path, offset), header.count(), place.type);
      break;
    case VoxelCoding::hexadecimal:
      *raw = bytes_of_digits(path, read_behind(place.file, path, offset), promised);
      break;
  }
  VolumeFile volume;
  volume.size = header.size;
  volume.spacing = header.spacing;
  const bool swapped = place.swapped && place.coding != VoxelCoding::numbers;
  volume.voxels = StoredVoxels(raw, raw->data(), header.count(), place.type, swapped);
  if (place.file != path) volume.files.push_back(place.file);
  return volume;
}

}  // namespace pellucid
