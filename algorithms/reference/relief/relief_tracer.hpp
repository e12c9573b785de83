#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include <glm/glm.hpp>

#include "algorithms/reference/relief/height_field.hpp"
#include "algorithms/reference/shading.hpp"
#include "algorithms/scene/meshes/tangents.hpp"
#include "algorithms/scene/noise.hpp"
#include "algorithms/scene/scene.hpp"

/// The look of a mesh that carries a relief, by exact hits: the optics and the shading of Timonen (references.bib:
/// timonen), Algorithms 1 and 2.
namespace pellucid {

/// How far the reference follows the paper.
struct ReliefOptics {
  /// Bend the lights' rays at the medium's surface, which the paper leaves straight (Sec. 3.1, footnote 4). The ray is
  /// found that leaves the medium towards the light; several may, as in a caustic, of which one is taken.
  bool refract_light = false;
};

/// A point of the mesh at which a ray arrives.
struct ReliefPlace {
  glm::dvec3 position{0.0};        ///< world
  SurfaceFrame<glm::dvec3> frame;  ///< world
  glm::dvec2 uv{0.0};
  glm::dvec3 tint{1.0};  ///< multiplies the solid's albedo

  glm::dvec3 to_frame(const glm::dvec3& d) const {
    return {glm::dot(d, frame.along_u), glm::dot(d, frame.along_v), glm::dot(d, frame.normal)};
  }
  glm::dvec3 to_world(const glm::dvec3& d) const {
    return d.x * frame.along_u + d.y * frame.along_v + d.z * frame.normal;
  }
  ReliefRay ray(const glm::dvec3& origin, const glm::dvec3& direction) const {
    return {origin, direction, uv, {1.0 / frame.metres_per_u, 1.0 / frame.metres_per_v}};
  }
};

/// The first thing that a ray meets.
struct ReliefHit {
  double distance_m = 0;  ///< from the mesh
  bool medium = false;    ///< the translucent layer; else the solid
};

class ReliefTracer {
 public:
  /// Share of a light that the scene's objects let through to a world point of the mesh, towards the unit vector.
  using Visible =
      std::function<bool(std::size_t light, const glm::dvec3& point, const glm::dvec3& to_light, double distance_m)>;

  /// The nearest object on a world ray up to that distance: how far, and its radiance.
  struct Object {
    double distance_m = 0;
    glm::dvec3 radiance{0.0};
  };
  using Objects =
      std::function<std::optional<Object>(const glm::dvec3& origin, const glm::dvec3& direction, double end_m)>;

  /// Keeps the addresses of the scene and the lights.
  ReliefTracer(const Scene&, int relief, const Illumination&, const ReliefOptics& = {});

  /// `direction` of unit length in the place's frame, downwards. Nothing where the ray leaves the surface unhit.
  std::optional<ReliefHit> first_hit(const ReliefPlace&, const glm::dvec3& direction) const;
  /// Radiance towards the ray's origin from that hit. Where the medium scatters it is that of one random walk in it,
  /// for which `random` is needed.
  glm::dvec3 radiance(const ReliefPlace&, const glm::dvec3& direction, const ReliefHit&, const Visible&,
                      const Objects& = {}, Random* random = nullptr) const;
  /// Share of light along `to_light` (frame, unit) that reaches the frame's point `p` on the `side` of the medium's
  /// surface: Algorithm 2 with absorption, and without the light that the medium scatters.
  glm::dvec3 light_reaching(const ReliefPlace&, const glm::dvec3& p, const glm::dvec3& to_light, double side) const;

  const HeightField& solid() const { return solid_; }
  const HeightField* medium() const { return medium_ ? &*medium_ : nullptr; }
  bool scatters() const { return relief_->scatters(); }

 private:
  struct Arriving {
    glm::dvec3 share{0.0}, direction{0.0, 0.0, 1.0};  // where it arrives from
  };
  Arriving arriving(const ReliefPlace&, const glm::dvec3& p, const glm::dvec3& to_light, double side) const;
  std::optional<double> meet(const HeightField&, const ReliefRay&, double from, double side) const;
  glm::dvec3 solid_radiance(const ReliefPlace&, const glm::dvec3& p, const glm::dvec3& v, const Visible&) const;
  double visible(const ReliefPlace&, const Visible&, std::size_t light, const glm::dvec3& p, const glm::dvec3& to_light,
                 double distance_m) const;
  double end_of(const ReliefRay&, double from) const;
  glm::dvec3 environment(const ReliefPlace&, const glm::dvec3& direction) const;
  glm::dvec3 solid_albedo(const ReliefPlace&, const glm::dvec2& uv) const;
  /// Light that a walk brings from the medium, at whose surface `p` it sets out inwards. Scattered light that leaves
  /// ends in the ambient light, and each place where it scatters is lit by the lights' straight rays. The solid is lit
  /// as elsewhere and sends a walk back into the medium once.
  glm::dvec3 walk(const ReliefPlace&, glm::dvec3 p, glm::dvec3 direction, const Visible&, const Objects&,
                  Random&) const;

  const Scene* scene_;
  const Relief* relief_;
  const Illumination* light_;
  ReliefOptics optics_;
  HeightField solid_;
  std::optional<HeightField> medium_;
};

}  // namespace pellucid
