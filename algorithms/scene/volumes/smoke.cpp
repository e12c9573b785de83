#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "algorithms/scene/noise.hpp"
#include "algorithms/scene/shapes/procedural.hpp"
#include "algorithms/scene/volumes/volume_rows.hpp"

namespace pellucid {

namespace {

/// 0 in the outermost voxels, 1 from `width` (a share of the axis) inwards. An axis of one voxel has no inside.
float away_from_faces(float position, int voxels, float width) {
  if (voxels == 1) return 1.0F;
  const float depth = std::min(position, 1.0F - position) - 0.5F / static_cast<float>(voxels);
  return glm::smoothstep(0.0F, width, depth);
}

/// A horizontal flow without sources, the curl of a potential: what it carries along winds and does not bunch up.
glm::vec2 swirl_at(const glm::vec3& p, std::uint32_t seed) {
  constexpr float kStep = 0.05F;
  const auto potential = [&](float x, float z) { return gradient_noise({x, p.y, z}, seed); };
  return glm::vec2(potential(p.x, p.z + kStep) - potential(p.x, p.z - kStep),
                   potential(p.x - kStep, p.z) - potential(p.x + kStep, p.z)) /
         (2.0F * kStep);
}

}  // namespace

std::vector<float> make_smoke_density(const glm::ivec3& size, const SmokeOptions& options) {
  assert(options.octaves >= 1 && options.frequency >= 0.0F);
  assert(options.contrast >= 0.0F && options.contrast <= 1.0F && options.swirl >= 0.0F);
  constexpr float kFade = 0.12F;                     // share of the box over which it fades towards the faces
  constexpr float kFoot = 0.06F, kWidening = 0.16F;  // radius at the bottom, and what it gains up to the top
  constexpr float kPeriods = 1.7F;                   // of the swirl across the box
  std::vector<float> density(voxel_count(size), 0.0F);
  for_each_row(size, density, [&](int j, int k, std::span<float> row) {
    const float v = voxel_centre(j, size.y), w = voxel_centre(k, size.z);
    const float radius = kFoot + kWidening * v;
    const float thinning = kFoot * kFoot / (radius * radius) * 0.7F + 0.3F;  // part of it spreads over the wider plume
    // It dissolves towards the top long before it gets there.
    const float rising = size.y == 1 ? 1.0F : 1.0F - glm::smoothstep(0.45F, 1.0F, v);
    const float fade = rising * away_from_faces(v, size.y, kFade) * away_from_faces(w, size.z, kFade);
    if (fade == 0.0F) return;
    for (std::size_t i = 0; i < row.size(); ++i) {
      const float u = voxel_centre(static_cast<int>(i), size.x);
      const float sides = fade * away_from_faces(u, size.x, kFade);
      if (sides == 0.0F) continue;
      // Carried along: what is here now was at `from`, the farther away the longer it has risen.
      const glm::vec2 drift =
          0.3F * options.swirl * v * swirl_at(kPeriods * glm::vec3(u, v, w), options.seed * 131U + 77U);
      const glm::vec2 from = glm::vec2(u, w) - drift;
      const float off_axis = glm::length(from - 0.5F) / radius;
      const float plume = std::exp(-off_axis * off_axis);
      if (plume < 1e-4F) continue;
      // Drawn out upwards.
      const float noise = fractal_noise(glm::vec3(from.x, 0.6F * v, from.y) * options.frequency + 0.618F,
                                        options.octaves, options.seed * 131U);
      const float thickness = std::clamp(0.45F + 2.4F * noise, 0.0F, 1.0F);
      row[i] = sides * thinning * plume * (1.0F - options.contrast * (1.0F - thickness));
    }
  });
  return density;
}

}  // namespace pellucid
