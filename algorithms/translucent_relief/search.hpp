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
/// start there.
template <class Above>
Crossing linear_crossing(Above above, const glm::vec2& range, float side, float bias, int steps, int refinements) {
  Crossing crossing;
  if (!(range.x < range.y)) return crossing;
  const float stride = (range.y - range.x) / static_cast<float>(steps);
  float before = range.x, after = range.x, height_before = std::max(side * above(range.x), 0.0F), height_after = 0.0F;
  ++crossing.taken;
  bool found = false;
  for (int i = 1; i <= steps && !found; ++i) {
    after = range.x + stride * static_cast<float>(i);
    height_after = side * above(after);
    ++crossing.taken;
    found = height_after < -bias;
    if (found) break;
    before = after;
    height_before = std::max(height_after, 0.0F);
  }
  if (!found) return crossing;
  for (int i = 0; i < refinements; ++i) {
    const float middle = 0.5F * (before + after), height = side * above(middle);
    ++crossing.taken;
    if (height < 0.0F) {
      after = middle;
      height_after = height;
    } else {
      before = middle;
      height_before = height;
    }
  }
  crossing.at = before + (after - before) * std::clamp(height_before / (height_before - height_after), 0.0F, 1.0F);
  return crossing;
}

}  // namespace pellucid::translucent_relief
