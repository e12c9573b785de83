#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "algorithms/scene/noise.hpp"
#include "algorithms/scene/shapes/procedural.hpp"
#include "algorithms/scene/volumes/volume_rows.hpp"

namespace pellucid {

namespace {

/// Three plane waves of unit amplitude in all, their directions and phases from the seed.
class Waves {
 public:
  explicit Waves(std::uint32_t seed) {
    Random random(seed, 9);
    for (Wave& wave : waves_) {
      const float direction = random.range(0.0F, 2.0F * std::numbers::pi_v<float>);
      const float periods = random.range(1.5F, 5.0F);  // across the box
      wave.vector = 2.0F * std::numbers::pi_v<float> * periods * glm::vec2(std::cos(direction), std::sin(direction));
      wave.phase = random.range(0.0F, 2.0F * std::numbers::pi_v<float>);
    }
  }
  float at(const glm::vec2& p) const {
    float sum = 0;
    for (const Wave& wave : waves_)
      sum += std::sin(glm::dot(wave.vector, p) + wave.phase) / 3.0F;
    return sum;
  }

 private:
  struct Wave {
    glm::vec2 vector{0.0F};
    float phase = 0;
  };
  Wave waves_[3];
};

}  // namespace

std::vector<float> make_water_density(const glm::ivec3& size, const WaterOptions& options) {
  assert(options.octaves >= 1 && options.frequency >= 0.0F && options.wave >= 0.0F);
  assert(options.contrast >= 0.0F && options.contrast <= 1.0F);
  assert(options.depth_gradient >= 0.0F && options.depth_gradient <= 1.0F);
  const Waves waves(options.seed);
  std::vector<float> density(voxel_count(size), 0.0F);
  for_each_row(size, density, [&](int j, int k, std::span<float> row) {
    const float v = voxel_centre(j, size.y), w = voxel_centre(k, size.z);
    const float depth = options.level > 0.0F ? std::clamp(1.0F - v / options.level, 0.0F, 1.0F) : 0.0F;
    const float layer = 1.0F - options.depth_gradient * (1.0F - depth);
    for (std::size_t i = 0; i < row.size(); ++i) {
      const float u = voxel_centre(static_cast<int>(i), size.x);
      const float surface = options.level + options.wave * waves.at({u, w});
      // The share of the voxel's height that is under the surface.
      const float wet = std::clamp((surface - v) * static_cast<float>(size.y) + 0.5F, 0.0F, 1.0F);
      if (wet == 0.0F) continue;
      const float noise =
          fractal_noise(glm::vec3(u, v, w) * options.frequency + 0.618F, options.octaves, options.seed * 131U);
      row[i] = wet * layer * (1.0F - options.contrast * std::clamp(0.5F - noise, 0.0F, 1.0F));
    }
  });
  return density;
}

}  // namespace pellucid
