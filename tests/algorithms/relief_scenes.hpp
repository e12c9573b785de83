#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "algorithms/scene/relief/patterns.hpp"
#include "algorithms/scene/scene.hpp"
#include "algorithms/scene/shapes/procedural.hpp"

/// Small reliefs with known answers, built in memory.
namespace pellucid::test {

/// Heights in [0, 1] and their slopes as a layer between `low_m` and `high_m`.
inline ReliefLayer layer_of(Image heights, float low_m, float high_m) {
  ReliefLayer layer;
  layer.low_m = low_m;
  layer.high_m = high_m;
  layer.normals = slopes_of(heights);
  layer.heights = std::move(heights);
  return layer;
}

/// At the height `high_m` everywhere.
inline ReliefLayer flat_layer(float high_m, float low_m) {
  Image heights(1, 1, 1);
  heights.pixels = {1.0F};
  return layer_of(std::move(heights), low_m, high_m);
}

/// A quad of 2 × 2 m in y = 0 under a directional light that comes from (0.6, 0.8, 0), seen from above.
inline Scene relief_scene(Relief relief) {
  Scene scene;
  scene.name = "relief";
  scene.meshes.push_back(make_plane({2.0F, 2.0F}, 1));
  scene.materials.push_back({.name = "white", .albedo = glm::vec3(1.0F)});
  scene.instances.push_back({.name = "ground"});
  scene.instances[0].relief = 0;
  relief.name = "relief";
  relief.maps_revision = 1;
  scene.reliefs.push_back(std::move(relief));
  scene.lights.push_back({.name = "sun",
                          .kind = LightKind::directional,
                          .direction = {-0.6F, -0.8F, 0.0F},
                          .intensity = {3.0F, 2.0F, 1.0F}});
  scene.ambient = glm::vec3(0.2F);
  scene.environment.zenith = scene.environment.horizon = scene.environment.ground = {0.1F, 0.2F, 0.4F};
  scene.views.push_back({.name = "front", .eye = {0.3F, 1.4F, 1.1F}, .target = {0.0F, 0.0F, 0.0F}, .fov_y_deg = 35.0F});
  return scene;
}

/// A smooth seamless field of random waves in [0, 1].
inline Image random_field(int size, std::uint32_t seed, int frequency = 3) {
  PatternOptions options;
  options.kind = Pattern::noise;
  options.width = options.height = size;
  options.seed = seed;
  options.frequency = frequency;
  options.octaves = 2;
  return make_pattern(options).heights;
}

}  // namespace pellucid::test
