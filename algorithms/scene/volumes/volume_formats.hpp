#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
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

/// What a header says, checked before anything is allocated.
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

/// How one voxel is written.
struct VoxelType {
  std::size_t bytes = 0;
  float (*value)(const char* bytes, bool swapped) = nullptr;
};
enum class VoxelKind { floating, unsigned_integer, signed_integer };
VoxelType voxel_type(VoxelKind, int bits);  ///< `bytes` is 0 when there is no such type
std::vector<float> decode_voxels(std::string_view raw, VoxelType, bool swapped);

/// The file's content behind `offset`.
std::string read_behind(const std::filesystem::path&, std::uintmax_t offset);

/// Unpacks zlib's or gzip's format piece by piece. Throws when it is damaged or ends too soon.
void unpack(const std::filesystem::path&, std::string_view packed,
            const std::function<void(std::string_view)>& take_piece);

}  // namespace pellucid
