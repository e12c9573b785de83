#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>

#include <glm/glm.hpp>

#include "algorithms/scene/noise.hpp"

namespace pellucid {

/// Places in a pixel's square: n cells of equal area, one random place in each, so that the variance of a mean is at
/// most that of n independent places. One sample is the centre.
class PixelSamples {
 public:
  PixelSamples(int count, std::uint32_t seed) : count_(count), seed_(seed) {
    assert(count > 0);
    rows_ = std::max(1, static_cast<int>(std::lround(std::sqrt(count))));
  }

  /// In [0, 1)², the same whatever the order in which pixels are asked.
  glm::dvec2 at(int x, int y, int sample) const {
    if (count_ == 1) return glm::dvec2(0.5);
    // Row r holds the samples from ⌈r·n/rows⌉ on: cells of as many columns as it holds, the row as high as they need.
    const int row = static_cast<int>(static_cast<std::int64_t>(sample) * rows_ / count_);
    const int first = first_of(row), in_row = first_of(row + 1) - first;
    const glm::dvec2 jitter(unit_float(hash_bits(x, y, 2 * sample, seed_)),
                            unit_float(hash_bits(x, y, 2 * sample + 1, seed_)));
    return {(sample - first + jitter.x) / in_row, (first + jitter.y * in_row) / count_};
  }

 private:
  int first_of(int row) const {
    return static_cast<int>((static_cast<std::int64_t>(row) * count_ + rows_ - 1) / rows_);
  }
  int count_;
  int rows_ = 1;
  std::uint32_t seed_;
};

}  // namespace pellucid
