#pragma once

#include <glm/gtc/matrix_transform.hpp>

#include "algorithms/scene/scene.hpp"
#include "algorithms/scene/shapes/procedural.hpp"

/// Small scenes with known answers, built in memory.
namespace pellucid::test {

inline Scene fog_box(const glm::ivec3& voxels, float density, float extinction) {
  Scene scene;
  scene.name = "fog_box";
  Volume volume;
  volume.name = "fog";
  volume.size = voxels;
  volume.density = make_constant_density(voxels, density);
  volume.extinction = extinction;
  // 2 × 1.5 × 4 m, turned, before the default view.
  volume.to_world = glm::rotate(glm::mat4(1.0F), 0.4F, glm::normalize(glm::vec3(0.3F, 1.0F, 0.1F))) *
                    glm::scale(glm::mat4(1.0F), glm::vec3(2.0F, 1.5F, 4.0F)) *
                    glm::translate(glm::mat4(1.0F), glm::vec3(-0.5F));
  scene.volume = volume;
  scene.ambient = glm::vec3(0.25F, 0.5F, 1.0F);
  scene.environment.zenith = scene.environment.horizon = scene.environment.ground = glm::vec3(0.9F, 0.3F, 0.1F);
  scene.views.push_back({.name = "front", .eye = {0.3F, 0.4F, 6.0F}, .target = glm::vec3(0.0F), .fov_y_deg = 35.0F});
  scene.views.push_back(
      {.name = "inside", .eye = {0.1F, 0.1F, 0.2F}, .target = {0.3F, 0.0F, -3.0F}, .fov_y_deg = 60.0F});
  scene.views.push_back({.name = "straddling",
                         .eye = {0.0F, 0.1F, 2.05F},
                         .target = {0.0F, 0.0F, -3.0F},
                         .fov_y_deg = 70.0F,
                         .near_m = 0.3F});
  scene.views.push_back({.name = "behind", .eye = {0.0F, 0.0F, 6.0F}, .target = {0.0F, 0.0F, 20.0F}});
  return scene;
}

/// The same with an opaque grey ball in the middle.
inline Scene fog_box_with_ball(const glm::ivec3& voxels, float density, float extinction) {
  Scene scene = fog_box(voxels, density, extinction);
  scene.meshes.push_back(make_sphere(0.5F, 64));
  scene.materials.push_back({.name = "grey", .albedo = glm::vec3(0.4F)});
  scene.instances.push_back({.name = "ball"});
  return scene;
}

}  // namespace pellucid::test
