#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

namespace pellucid {

inline constexpr int kMaxVoxelsPerAxis = 2048;
inline constexpr std::uint64_t kMaxVoxels = std::uint64_t{1} << 30;

struct VolumeFile {
  glm::ivec3 size{0};
  glm::dvec3 spacing{1.0};                   ///< between voxel centres, in the file's unit
  std::vector<float> values;                 ///< x fastest; finite
  std::vector<std::filesystem::path> files;  ///< the file, and the data file that it refers to
};

/// Reads VTK XML image data (.vti), MetaImage (.mhd, .mha), NRRD (.nrrd, .nhdr) or INRIMAGE-4 (.inr) with one scalar a
/// voxel. Origin and orientation are left aside. Throws InputError: missing, truncated or malformed, more voxels than
/// allowed (before they are allocated), or a value that is not finite.
VolumeFile load_volume_file(const std::filesystem::path&);

/// Maps [range.x, range.y] to [0, 1] and what lies beyond to the ends; without a range, that of the data. Returns the
/// range used. Throws InputError when the data are all the same and no range is given.
glm::dvec2 normalise(VolumeFile&, const std::optional<glm::dvec2>& range);

}  // namespace pellucid
