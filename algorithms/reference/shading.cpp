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
                       cos_deg(light.outer_angle_deg)});
  }
}

Incidence Illumination::incidence(std::size_t light, const glm::dvec3& point) const {
  const Emitter& emitter = lights_[light];
  if (emitter.kind == LightKind::directional) return {emitter.intensity, -emitter.direction};
  const glm::dvec3 offset = emitter.position - point;
  const double distance2 = glm::dot(offset, offset);
  const glm::dvec3 to_light = offset / std::sqrt(distance2);
  double spot = 1.0;
  if (emitter.kind == LightKind::spot) {
    spot = glm::smoothstep(emitter.cos_outer, emitter.cos_inner, -glm::dot(to_light, emitter.direction));
  }
  return {emitter.intensity * (spot / distance2), to_light};
}

glm::dvec3 Illumination::surface_radiance(const glm::dvec3& point, const glm::dvec3& normal, const glm::dvec3& albedo,
                                          const glm::dvec3& emission) const {
  glm::dvec3 incident = ambient_;
  for (std::size_t i = 0; i < lights_.size(); ++i) {
    const Incidence in = incidence(i, point);
    incident += in.irradiance * (std::max(glm::dot(normal, in.to_light), 0.0) / std::numbers::pi);
  }
  return emission + albedo * incident;
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
