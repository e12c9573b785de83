#pragma once

#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>

/// Where a ray meets a height field (Timonen, Sec. 2 and 3). GLSL twin: algorithms/translucent_relief/search.glsl.
namespace pellucid::translucent_relief {

struct Crossing {
  float at = -1.0F;  ///< along the ray; negative: none
  int taken = 0;     ///< heights that were asked for
};

/// The first crossing in `range` of a ray that begins on `side` of the layer (1: above it, −1: below): a linear search,
/// then halving (Policarpo et al. 2005), then the chord of the last bracket (Tatarchuk 2006). `above(t)`: the height of
/// the ray's point over the layer. A point less than `bias` metres beyond counts as on it, for the sake of rays that
/// start there. Steps are taken four at a time.
template <class Above>
Crossing linear_crossing(Above above, const glm::vec2& range, float side, float bias, int steps, int refinements) {
  Crossing crossing;
  if (!(range.x < range.y)) return crossing;
  const float stride = (range.y - range.x) / static_cast<float>(steps);
  const auto height_after = [&](float k) { return side * above(range.x + stride * k); };
  // After so many steps, and the heights there.
  float before = 0.0F, after = 0.0F, height_before = height_after(0.0F), height = 0.0F;
  bool found = false;
  crossing.taken = 1;
  for (int i = 1; i <= steps && !found; ++i) {
    if (i % 4 == 1) crossing.taken += 4;
    after = static_cast<float>(i);
    height = height_after(after);
    found = height < -bias;
    if (!found) {
      before = after;
      height_before = height;
    }
  }
  if (!found) return crossing;
  height_before = std::max(height_before, 0.0F);
  for (int i = 0; i < refinements; ++i) {
    const float middle = 0.5F * (before + after), at_middle = height_after(middle);
    if (at_middle < 0.0F) {
      after = middle;
      height = at_middle;
    } else {
      before = middle;
      height_before = at_middle;
    }
  }
  crossing.taken += refinements;
  const float share = std::clamp(height_before / (height_before - height), 0.0F, 1.0F);
  crossing.at = range.x + stride * (before + (after - before) * share);
  return crossing;
}

}  // namespace pellucid::translucent_relief
