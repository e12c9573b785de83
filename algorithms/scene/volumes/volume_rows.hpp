#pragma once

#include <cassert>
#include <cstddef>
#include <span>
#include <vector>

#include <glm/glm.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

/// For the procedural volumes: voxels by rows of x, in parallel.
namespace pellucid {

inline std::size_t voxel_count(const glm::ivec3& size) {
  assert(size.x > 0 && size.y > 0 && size.z > 0);
  return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z);
}

inline float voxel_centre(int i, int n) {
  return (static_cast<float>(i) + 0.5F) / static_cast<float>(n);
}

/// Calls row(y, z, the voxels of that row) for every row.
template <class F>
void for_each_row(const glm::ivec3& size, std::vector<float>& density, F row) {
  const auto width = static_cast<std::size_t>(size.x);
  tbb::parallel_for(tbb::blocked_range<int>(0, size.z), [&](const tbb::blocked_range<int>& slab) {
    for (int z = slab.begin(); z < slab.end(); ++z) {
      for (int y = 0; y < size.y; ++y) {
        const std::size_t first =
            (static_cast<std::size_t>(z) * static_cast<std::size_t>(size.y) + static_cast<std::size_t>(y)) * width;
        row(y, z, std::span<float>(density.data() + first, width));
      }
    }
  });
}

}  // namespace pellucid
