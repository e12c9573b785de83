#pragma once

#include <glm/glm.hpp>

#include "algorithms/reference/geometry.hpp"
#include "algorithms/scene/scene.hpp"

namespace pellucid {

/// A point of a surface as a ray sees it, ready to be lit or to send the ray on.
struct SurfacePoint {
  glm::dvec3 position{0.0};
  glm::dvec3 normal{0.0};  ///< unit, interpolated; on the ray's side of the triangle
  glm::dvec3 face{0.0};    ///< unit, the triangle's own, towards the side that the ray comes from
  bool front = true;       ///< that side is the one the mesh's triangles are wound for: the outside of a solid
  glm::dvec3 albedo{0.0}, emission{0.0};
  double distance = 0.0;  ///< from the ray's origin
};

/// `hit` of a ray from `origin` along the unit `direction`, with vertex colours and tints applied.
SurfacePoint surface_at(const Scene&, const Geometry&, const Hit& hit, const glm::dvec3& origin,
                        const glm::dvec3& direction);

}  // namespace pellucid
