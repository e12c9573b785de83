#pragma once

#include <cstddef>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/scene/scene.hpp"

/// Light on surfaces and in the medium, in double precision: the C++ twin of algorithms/shaders/common/lighting.glsl.
namespace pellucid {

/// What a light gives to a plane at a point that faces it.
struct Incidence {
  glm::dvec3 irradiance{0.0};  ///< at normal incidence, unshadowed
  glm::dvec3 to_light{0.0};    ///< unit
};

/// The lights of a scene, ready to be asked often. Keeps no reference to the scene.
class Illumination {
 public:
  explicit Illumination(const Scene&);

  std::size_t light_count() const { return lights_.size(); }
  Incidence incidence(std::size_t light, const glm::dvec3& point) const;

  /// Radiance of a Lambertian surface: emission + albedo · (ambient + Σ E cos θ / π). `normal` unit, turned to the
  /// viewer.
  glm::dvec3 surface_radiance(const glm::dvec3& point, const glm::dvec3& normal, const glm::dvec3& albedo,
                              const glm::dvec3& emission) const;
  /// Source radiance of the medium, with isotropic single scattering: emission + albedo · (ambient + Σ E / 4π).
  glm::dvec3 medium_radiance(const glm::dvec3& point, const glm::dvec3& albedo, const glm::dvec3& emission) const;
  /// True if medium_radiance() is the same everywhere, because every light is directional.
  bool uniform() const;

 private:
  struct Emitter {
    LightKind kind;
    glm::dvec3 position, direction, intensity;
    double cos_inner, cos_outer;  // a spot's full cone, and where it reaches zero
  };
  std::vector<Emitter> lights_;
  glm::dvec3 ambient_;
};

}  // namespace pellucid
