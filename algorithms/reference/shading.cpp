#include "algorithms/reference/shading.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pellucid {

double spot_falloff(const Light& light, double cosine) {
  const double inner = std::cos(glm::radians(static_cast<double>(light.inner_angle_deg)));
  const double outer = std::cos(glm::radians(static_cast<double>(light.outer_angle_deg)));
  return glm::smoothstep(outer, inner, cosine);
}

Incidence incidence(const Light& light, const glm::dvec3& point) {
  const glm::dvec3 intensity(light.intensity), axis(light.direction);
  if (light.kind == LightKind::directional) return {intensity, -axis};
  const glm::dvec3 offset = glm::dvec3(light.position) - point;
  const double distance2 = glm::dot(offset, offset);
  const glm::dvec3 to_light = offset / std::sqrt(distance2);
  const double spot = light.kind == LightKind::spot ? spot_falloff(light, glm::dot(-to_light, axis)) : 1.0;
  return {intensity * (spot / distance2), to_light};
}

glm::dvec3 surface_radiance(const Scene& scene, const glm::dvec3& point, const glm::dvec3& normal,
                            const glm::dvec3& albedo, const glm::dvec3& emission) {
  glm::dvec3 incident(scene.ambient);
  for (const Light& light : scene.lights) {
    const Incidence in = incidence(light, point);
    incident += in.irradiance * (std::max(glm::dot(normal, in.to_light), 0.0) / std::numbers::pi);
  }
  return emission + albedo * incident;
}

glm::dvec3 medium_radiance(const Scene& scene, const glm::dvec3& point, const glm::dvec3& albedo,
                           const glm::dvec3& emission) {
  glm::dvec3 incident(scene.ambient);
  for (const Light& light : scene.lights)
    incident += incidence(light, point).irradiance / (4.0 * std::numbers::pi);
  return emission + albedo * incident;
}

bool uniform_source(const Scene& scene) {
  return std::all_of(scene.lights.begin(), scene.lights.end(),
                     [](const Light& light) { return light.kind == LightKind::directional; });
}

}  // namespace pellucid
