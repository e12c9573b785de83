#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <glm/gtc/matrix_transform.hpp>

#include "algorithms/reference/reference.hpp"
#include "algorithms/scene/scene.hpp"
#include "algorithms/scene/shapes/procedural.hpp"

/// Small scenes of mirrors, metals and dielectrics whose answer is known.
namespace pellucid::test {

inline constexpr double kPi = std::numbers::pi;

inline Material mirror(float reflectance = 1.0F) {
  return {.name = "mirror", .kind = SurfaceKind::mirror, .reflectance = glm::vec3(reflectance)};
}
inline Material glass(float ior, const glm::vec3& absorption = glm::vec3(0.0F)) {
  return {.name = "glass", .kind = SurfaceKind::dielectric, .ior = ior, .absorption = absorption};
}
inline Material matte(const glm::vec3& albedo, const glm::vec3& emission = glm::vec3(0.0F)) {
  return {.name = "matte", .albedo = albedo, .emission = emission};
}

/// Adds the mesh with a material of its own; returns the instance's index.
inline int add(Scene& scene, Mesh mesh, const Material& material, const glm::mat4& to_world = glm::mat4(1.0F)) {
  scene.instances.push_back({"object " + std::to_string(scene.instances.size()), static_cast<int>(scene.meshes.size()),
                             static_cast<int>(scene.materials.size()), to_world, glm::vec3(1.0F)});
  scene.meshes.push_back(std::move(mesh));
  scene.materials.push_back(material);
  return static_cast<int>(scene.instances.size()) - 1;
}

inline glm::mat4 at(const glm::vec3& position) {
  return glm::translate(glm::mat4(1.0F), position);
}

inline void set_environment(Scene& scene, const glm::vec3& up, const glm::vec3& level, const glm::vec3& down) {
  scene.environment.zenith = up;
  scene.environment.horizon = level;
  scene.environment.ground = down;
}
inline void set_furnace(Scene& scene) {
  set_environment(scene, glm::vec3(1.0F), glm::vec3(1.0F), glm::vec3(1.0F));
}

inline Camera looking(const glm::vec3& eye, const glm::vec3& target, int pixels, float fov_y_deg = 45.0F,
                      const glm::vec3& up = {0, 1, 0}) {
  Camera camera;
  camera.view.eye = eye;
  camera.view.target = target;
  camera.view.up = up;
  camera.view.fov_y_deg = fov_y_deg;
  const float distance = glm::distance(eye, target);
  camera.view.near_m = 1e-4F * distance;
  camera.view.far_m = 1e4F * distance;
  camera.width = camera.height = pixels;
  return camera;
}

inline glm::dvec3 pixel(const Image& image, int x, int y) {
  const float* p = image.at(x, y);
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

/// The radiance that one ray sees: a picture of one pixel.
inline glm::dvec3 seen(const Scene& scene, const glm::vec3& eye, const glm::vec3& target,
                       const SurfaceOptions& options = {}, const glm::vec3& up = {0, 1, 0}) {
  return pixel(trace_surfaces(scene, looking(eye, target, 1, 1.0F, up), options).radiance, 0, 0);
}

/// Fresnel's share by its definition, from the angles: `eta` as in optics.hpp.
inline double fresnel_of_angles(double angle, double eta) {
  const double sine = eta * std::sin(angle);
  if (sine >= 1.0) return 1.0;
  const double behind = std::asin(sine);
  if (angle < 1e-9) return std::pow((eta - 1.0) / (eta + 1.0), 2.0);
  const double s = std::sin(angle - behind) / std::sin(angle + behind);
  const double p = std::tan(angle - behind) / std::tan(angle + behind);
  return 0.5 * (s * s + p * p);
}

}  // namespace pellucid::test
