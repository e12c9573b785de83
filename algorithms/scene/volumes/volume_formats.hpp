#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "algorithms/scene/volumes/volume_file.hpp"

/// Behind load_volume_file(): one function a format, and what they share.
namespace pellucid {

VolumeFile load_inr(const std::filesystem::path&);
VolumeFile load_nrrd(const std::filesystem::path&);
VolumeFile load_vti(const std::filesystem::path&);
VolumeFile load_meta_image(const std::filesystem::path&);

[[noreturn]] void fail_volume(const std::filesystem::path&, std::string_view reason);

/// A header's claims, checked before anything is allocated.
struct VolumeHeader {
  glm::ivec3 size{0};
  glm::dvec3 spacing{1.0};
  int components = 1;
  std::size_t count() const { return std::size_t(size.x) * std::size_t(size.y) * std::size_t(size.z); }
};
/// `bytes`: of all the files that hold the data.
void check_header(const std::filesystem::path&, const VolumeHeader&, std::uintmax_t bytes);

/// A number of a header. Throws when the text is anything else.
double header_number(const std::filesystem::path&, std::string_view field, std::string_view text);
/// … and a whole one that is not negative.
int header_size(const std::filesystem::path&, std::string_view field, std::string_view text);

enum class VoxelKind { floating, unsigned_integer, signed_integer };
VoxelType voxel_type(VoxelKind, int bits);  ///< `bytes` is 0 when there is no such type

enum class VoxelCoding {
  raw,
  packed,       ///< by zlib or gzip
  numbers,      ///< as text
  hexadecimal,  ///< two digits a byte
};

/// Where a header says that the voxels lie, and how they are written.
struct VoxelBytes {
  std::filesystem::path file;
  std::uintmax_t offset = 0;
  VoxelCoding coding = VoxelCoding::raw;
  bool from_end = false;    ///< they end where the file ends, and what comes before them is skipped
  bool may_follow = false;  ///< what comes behind them is left aside
  VoxelType type;
  bool swapped = false;
};
/// Checks the header against the file and reads them. `path` is the header's file, for errors.
VolumeFile read_voxels(const std::filesystem::path& path, const VolumeHeader&, const VoxelBytes&);

/// Voxels of `type` in this machine's byte order, from numbers between blanks; a comma may end a number.
std::string voxels_of_numbers(const std::filesystem::path&, std::string_view text, std::size_t count, const VoxelType&);
/// Bytes from pairs of hexadecimal digits; blanks may stand anywhere.
std::string bytes_of_digits(const std::filesystem::path&, std::string_view text, std::size_t promised);

/// The file that a header names beside itself. Lists and numbered slices are refused; `%` may be a part of a name.
std::filesystem::path data_file(const std::filesystem::path& path, const std::string& name);

}  // namespace pellucid
