#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "algorithms/scene/volumes/volume_formats.hpp"

namespace pellucid::test {

/// Gives the volume these values, as a file of 32-bit floats would.
inline void store(VolumeFile& volume, std::vector<float> values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  volume.value_range = {static_cast<double>(*low), static_cast<double>(*high)};
  const auto owner = std::make_shared<std::vector<float>>(std::move(values));
  volume.voxels = StoredVoxels(owner, reinterpret_cast<const char*>(owner->data()), owner->size(),
                               voxel_type(VoxelKind::floating, 32), false);
}

inline std::vector<double> values_of(const VolumeFile& volume) {
  std::vector<double> values;
  for (std::size_t i = 0; i < volume.voxels.size(); ++i)
    values.push_back(volume.voxels[i]);
  return values;
}

}  // namespace pellucid::test
