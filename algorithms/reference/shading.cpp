#include "algorithms/reference/shading.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pellucid {
namespace {

double cos_deg(float angle_deg) {
  return std::cos(glm::radians(static_cast<double>(angle_deg)));
}

}  // namespace

Illumination::Illumination(const Scene& scene) : ambient_(scene.ambient) {
  for (const Light& light : scene.lights) {
    lights_.push_back({light.kind, light.position, light.direction, light.intensity, cos_deg(light.inner_angle_deg),
                       cos_deg(light.outer_angle_deg), light.casts_shadow});
  }
}

Incidence Illumination::incidence(std::size_t light, const glm::dvec3& point) const {
  const Emitter& emitter = lights_[light];
  if (emitter.kind == LightKind::directional) {
    return {emitter.intensity, -emitter.direction, std::numeric_limits<double>::infinity()};
  }
  const glm::dvec3 offset = emitter.position - point;
  const double distance2 = glm::dot(offset, offset);
  const double distance = std::sqrt(distance2);
  const glm::dvec3 to_light = offset / distance;
  double spot = 1.0;
  if (emitter.kind == LightKind::spot) {
    spot = glm::smoothstep(emitter.cos_outer, emitter.cos_inner, -glm::dot(to_light, emitter.direction));
  }
  return {emitter.intensity * (spot / distance2), to_light, distance};
}

glm::dvec3 Illumination::surface_radiance(const glm::dvec3& point, const glm::dvec3& normal, const glm::dvec3& albedo,
                                          const glm::dvec3& emission) const {
  return surface_radiance(point, normal, albedo, emission, [](std::size_t, const Incidence&) { return true; });
}

glm::dvec3 Illumination::medium_radiance(const glm::dvec3& point, const glm::dvec3& albedo,
                                         const glm::dvec3& emission) const {
  glm::dvec3 incident = ambient_;
  for (std::size_t i = 0; i < lights_.size(); ++i)
    incident += incidence(i, point).irradiance / (4.0 * std::numbers::pi);
  return emission + albedo * incident;
}

bool Illumination::uniform() const {
  return std::all_of(lights_.begin(), lights_.end(),
                     [](const Emitter& emitter) { return emitter.kind == LightKind::directional; });
}

}  // namespace pellucid
