#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

namespace pellucid {

inline constexpr int kMaxVoxelsPerAxis = 2048;
inline constexpr std::uint64_t kMaxVoxels = std::uint64_t{1} << 30;

/// How one voxel is stored.
struct VoxelType {
  std::size_t bytes = 0;
  double (*value)(const char* bytes, bool swapped) = nullptr;
  bool (*store)(double value, char* bytes) = nullptr;  ///< false when the type cannot hold it
};

/// Voxels as the file stores them, x fastest. Their values are doubles: large integers and small steps on a large
/// offset would not survive 32 bits before the range is taken off.
class StoredVoxels {
 public:
  StoredVoxels() = default;
  /// `owner` keeps `bytes` alive.
  StoredVoxels(std::shared_ptr<const void> owner, const char* bytes, std::size_t count, VoxelType type, bool swapped)
      : owner_(std::move(owner)), bytes_(bytes), count_(count), type_(type), swapped_(swapped) {}
  std::size_t size() const { return count_; }
  double operator[](std::size_t i) const { return type_.value(bytes_ + i * type_.bytes, swapped_); }

 private:
  std::shared_ptr<const void> owner_;
  const char* bytes_ = nullptr;
  std::size_t count_ = 0;
  VoxelType type_;
  bool swapped_ = false;
};

struct VolumeFile {
  glm::ivec3 size{0};
  glm::dvec3 spacing{1.0};                   ///< between voxel centres, in the file's unit
  StoredVoxels voxels;                       ///< finite
  std::vector<std::filesystem::path> files;  ///< the file, and the data file that it refers to
  glm::dvec2 value_range{0.0};               ///< the lowest and the highest value
};

/// Reads VTK XML image data (.vti), MetaImage (.mhd, .mha), NRRD (.nrrd, .nhdr) or INRIMAGE-4 (.inr) with one scalar a
/// voxel; the extension's case does not matter. Origin and orientation are left aside. Throws InputError: missing,
/// truncated or malformed, a header field that matters and is not understood, more voxels than allowed (before they are
/// allocated), or a value that is not finite.
VolumeFile load_volume_file(const std::filesystem::path&);

struct Densities {
  std::vector<float> values;  ///< in [0, 1], x fastest
  glm::dvec2 range{0.0};      ///< the values in the file that became 0 and 1
};
/// Maps [range.x, range.y] to [0, 1] and what lies beyond to the ends; without a range, that of the data. Throws
/// InputError when the data are all the same and no range is given.
Densities normalise(const VolumeFile&, const std::optional<glm::dvec2>& range);

}  // namespace pellucid
