#pragma once

#include <glm/glm.hpp>

#include "algorithms/scene/scene.hpp"

/// Light on surfaces and in the medium, in double precision: the C++ twin of algorithms/shaders/common/lighting.glsl.
namespace pellucid {

/// What a light gives to a plane at a point that faces it.
struct Incidence {
  glm::dvec3 irradiance{0.0};  ///< at normal incidence, unshadowed
  glm::dvec3 to_light{0.0};    ///< unit
};

/// The share of a spot's intensity that reaches a direction whose angle to the axis has this cosine: 1 inside the inner
/// cone, 0 outside the outer one, smoothstep of the cosine between.
double spot_falloff(const Light&, double cosine);

Incidence incidence(const Light&, const glm::dvec3& point);

/// Radiance of a Lambertian surface: emission + albedo · (ambient + Σ E cos θ / π). `normal` unit, turned to the
/// viewer.
glm::dvec3 surface_radiance(const Scene&, const glm::dvec3& point, const glm::dvec3& normal, const glm::dvec3& albedo,
                            const glm::dvec3& emission);

/// Source radiance of the medium, with isotropic single scattering: emission + albedo · (ambient + Σ E / 4π).
glm::dvec3 medium_radiance(const Scene&, const glm::dvec3& point, const glm::dvec3& albedo, const glm::dvec3& emission);

/// True if medium_radiance() is the same everywhere, because every light is directional.
bool uniform_source(const Scene&);

}  // namespace pellucid
