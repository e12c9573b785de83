#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/scene/scene.hpp"

namespace pellucid {

/// How a mesh's texture lies on it: at each vertex the derivatives of the position over u and v [m], means of the
/// triangles around it by their areas.
struct Tangents {
  std::vector<glm::vec3> u, v;
};

/// InputError, which names `what`, if the mesh has no texture coordinates, or a vertex whose triangles' coordinates
/// span no area.
Tangents tangents_of(const Mesh&, const std::string& what);

/// The orthonormal frame of a surface point, and what it measures: metres over a unit of u and of v. `normal` unit.
/// The texture's shear is left out.
template <class Vec3>
struct SurfaceFrame {
  Vec3 along_u, along_v, normal;
  typename Vec3::value_type metres_per_u, metres_per_v;
};
template <class Vec3>
SurfaceFrame<Vec3> surface_frame(const Vec3& normal, const Vec3& over_u, const Vec3& over_v) {
  SurfaceFrame<Vec3> frame;
  frame.normal = normal;
  const Vec3 u = over_u - normal * glm::dot(normal, over_u);
  frame.metres_per_u = glm::length(u);
  frame.along_u = u / frame.metres_per_u;
  frame.along_v = glm::cross(normal, frame.along_u);
  const auto v = glm::dot(frame.along_v, over_v);
  frame.metres_per_v = glm::abs(v);
  if (v < 0) frame.along_v = -frame.along_v;
  return frame;
}

}  // namespace pellucid
