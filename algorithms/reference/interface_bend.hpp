#pragma once

#include <optional>

#include <glm/glm.hpp>

/// The effect of a smooth interface on one ray.
namespace pellucid {

struct Bend {
  glm::dvec3 normal{0.0};     ///< the one used, unit, on the arriving side
  double cosine = 1.0;        ///< of the angle of incidence to it
  glm::dvec3 reflected{0.0};  ///< unit, on the arriving side of the triangle
};

/// Mirror direction of a ray along `direction`. `normal` is interpolated, `face` the triangle's own, both unit and on
/// the side that the ray comes from. Where `normal` is turned from the ray, or would send the reflection through the
/// triangle, it is bent towards `face` just so far that it does not; this is continuous in the point.
Bend reflect_at(const glm::dvec3& direction, const glm::dvec3& normal, const glm::dvec3& face);

struct Split : Bend {
  double reflected_share = 1.0;         ///< Fresnel's, for unpolarised light
  std::optional<glm::dvec3> refracted;  ///< unit, behind the triangle; nothing at total reflection
};

/// The same at a dielectric, `eta` the index before the interface over the index behind it; the refracted ray does not
/// turn back through the triangle either.
Split split_at(const glm::dvec3& direction, const glm::dvec3& normal, const glm::dvec3& face, double eta);

}  // namespace pellucid
