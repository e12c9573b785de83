#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/reference/geometry.hpp"
#include "algorithms/reference/relief/relief_tracer.hpp"
#include "algorithms/reference/surface_point.hpp"

namespace pellucid {

/// The scene's meshes that carry reliefs, ready for rays that meet them.
class ReliefSurfaces {
 public:
  /// Keeps the addresses. InputError: a mesh without tangents.
  ReliefSurfaces(const Scene&, const Geometry&, const Illumination&, const ReliefOptics&);

  /// Radiance from the relief whose mesh the ray hits at `point`, and how far under the mesh it is met [m]; nothing
  /// where the ray leaves the relief unhit, or comes from behind. `rays` counts those to the lights; `random` is used
  /// where a medium scatters.
  struct Seen {
    glm::dvec3 radiance{0.0};
    double deeper_m = 0;
  };
  std::optional<Seen> seen(const Hit&, const SurfacePoint& point, const glm::dvec3& direction, Random& random,
                           std::uint64_t& rays) const;

 private:
  ReliefPlace place_of(const Hit&, const SurfacePoint&) const;
  std::optional<ReliefTracer::Object> object_on(const glm::dvec3& origin, const glm::dvec3& direction, double end_m,
                                                std::uint64_t& rays) const;

  const Scene* scene_;
  const Geometry* geometry_;
  const Illumination* light_;
  std::optional<Geometry> objects_;    // the Lambertian ones; nothing where there is none
  std::map<int, Tangents> tangents_;   // by mesh
  std::vector<ReliefTracer> tracers_;  // by relief
};

}  // namespace pellucid
