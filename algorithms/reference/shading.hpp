#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/scene/scene.hpp"

/// Light on surfaces and in the medium, in double precision: the C++ twin of algorithms/shaders/lighting.glsl.
namespace pellucid {

/// A light's irradiance on a plane at a point that faces it.
struct Incidence {
  glm::dvec3 irradiance{0.0};                                 ///< at normal incidence, unshadowed
  glm::dvec3 to_light{0.0};                                   ///< unit
  double distance = std::numeric_limits<double>::infinity();  ///< to the light [m]
};

/// The lights of a scene, ready to be asked often. Keeps no reference to the scene.
class Illumination {
 public:
  struct Emitter {
    LightKind kind;
    glm::dvec3 position, direction, intensity;
    double cos_inner, cos_outer;  ///< a spot's full cone, and where it reaches zero
    bool casts_shadow;
  };

  explicit Illumination(const Scene&);

  const std::vector<Emitter>& lights() const { return lights_; }
  std::size_t light_count() const { return lights_.size(); }
  bool casts_shadow(std::size_t light) const { return lights_[light].casts_shadow; }
  const glm::dvec3& ambient() const { return ambient_; }
  Incidence incidence(std::size_t light, const glm::dvec3& point) const;

  /// Radiance of a Lambertian surface: emission + albedo · (ambient + Σ V E cos θ / π). `normal` unit, turned to the
  /// viewer. `visible(light, incidence)` is V, asked of the lights that the normal faces.
  template <class F>
  glm::dvec3 surface_radiance(const glm::dvec3& point, const glm::dvec3& normal, const glm::dvec3& albedo,
                              const glm::dvec3& emission, F visible) const;
  /// The same with all lights in sight.
  glm::dvec3 surface_radiance(const glm::dvec3& point, const glm::dvec3& normal, const glm::dvec3& albedo,
                              const glm::dvec3& emission) const;
  /// Source radiance of the medium, with isotropic single scattering: emission + albedo · (ambient + Σ E / 4π), all
  /// lights in sight.
  glm::dvec3 medium_radiance(const glm::dvec3& point, const glm::dvec3& albedo, const glm::dvec3& emission) const;
  /// True if medium_radiance() is the same everywhere, because every light is directional.
  bool uniform() const;

 private:
  std::vector<Emitter> lights_;
  glm::dvec3 ambient_;
};

template <class F>
glm::dvec3 Illumination::surface_radiance(const glm::dvec3& point, const glm::dvec3& normal, const glm::dvec3& albedo,
                                          const glm::dvec3& emission, F visible) const {
  glm::dvec3 incident = ambient_;
  for (std::size_t i = 0; i < lights_.size(); ++i) {
    const Incidence in = incidence(i, point);
    const double cosine = glm::dot(normal, in.to_light);
    if (cosine > 0.0 && visible(i, in)) incident += in.irradiance * (cosine / std::numbers::pi);
  }
  return emission + albedo * incident;
}

}  // namespace pellucid
