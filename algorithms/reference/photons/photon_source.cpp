#include "algorithms/reference/photons/photon_source.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace pellucid {
namespace {

using std::numbers::pi;

}  // namespace

Sphere bounding_sphere(const Scene& scene, int instance) {
  const Instance& object = scene.instances[static_cast<std::size_t>(instance)];
  const std::vector<glm::vec3>& positions = scene.meshes[static_cast<std::size_t>(object.mesh)].positions;
  const auto placed = [&](const glm::vec3& p) {
    return glm::dvec3(glm::dmat4(object.to_world) * glm::dvec4(glm::dvec3(p), 1.0));
  };
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const glm::vec3& p : positions) {
    low = glm::min(low, placed(p));
    high = glm::max(high, placed(p));
  }
  Sphere sphere;
  if (positions.empty()) return sphere;
  sphere.center = 0.5 * (low + high);
  for (const glm::vec3& p : positions)
    sphere.radius = std::max(sphere.radius, glm::distance(placed(p), sphere.center));
  sphere.radius *= 1.0 + 1e-6;
  return sphere;
}

PhotonSource::PhotonSource(const Illumination::Emitter& light, const Sphere& object, double scene_size)
    : light_(light), object_(object) {
  const glm::dvec3 offset = object.center - light.position;
  const double distance = glm::length(offset);
  if (light.kind == LightKind::directional) {
    axis_ = light.direction;
    start_m_ = scene_size;
  } else if (distance > object.radius) {
    axis_ = offset / distance;
    const double sine = object.radius / distance;
    cap_ = sine * sine / (1.0 + std::sqrt(1.0 - sine * sine));
  } else {  // from inside the sphere: everywhere
    axis_ = {0.0, 1.0, 0.0};
  }
  const glm::dvec3 other = std::abs(axis_.y) < 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(1.0, 0.0, 0.0);
  right_ = glm::normalize(glm::cross(axis_, other));
  up_ = glm::cross(right_, axis_);
}

PhotonSource::Photon PhotonSource::at(const glm::dvec2& place) const {
  const double angle = 2.0 * pi * place.y;
  const glm::dvec3 outwards = std::cos(angle) * right_ + std::sin(angle) * up_;
  Photon photon;
  if (light_.kind == LightKind::directional) {
    const double r = object_.radius;
    photon.origin = object_.center - start_m_ * axis_ + r * std::sqrt(place.x) * outwards;
    photon.direction = axis_;
    photon.power = light_.intensity * (pi * r * r);
    return photon;
  }
  // Archimedes: evenly in the height on the unit sphere is evenly in solid angle.
  const double height = place.x * cap_;
  const double cosine = 1.0 - height, sine = std::sqrt(std::max(0.0, height * (2.0 - height)));
  photon.origin = light_.position;
  photon.direction = glm::normalize(cosine * axis_ + sine * outwards);
  double spot = 1.0;
  if (light_.kind == LightKind::spot)
    spot = glm::smoothstep(light_.cos_outer, light_.cos_inner, glm::dot(photon.direction, light_.direction));
  photon.power = light_.intensity * (spot * 2.0 * pi * cap_);
  return photon;
}

}  // namespace pellucid
