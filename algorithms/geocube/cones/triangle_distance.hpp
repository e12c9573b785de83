#pragma once

#include <array>
#include <limits>

#include <glm/glm.hpp>

namespace pellucid::geocube {

inline double squared(const glm::dvec3& v) {
  return glm::dot(v, v);
}

/// A circular cone without a base: the points whose direction from `apex` is within the half-angle of `axis`.
struct Cone {
  glm::dvec3 apex{0.0};
  glm::dvec3 axis{0.0, 0.0, 1.0};  ///< unit
  double cosine = 1;               ///< of the half-angle, in [0, 1]
  double sine = 0;
};

/// Distance from the origin to the nearest point of a triangle.
double distance_to_triangle(const std::array<glm::dvec3, 3>& corners);

/// Distance from the cone's apex to the nearest point of the triangle in the cone; infinite when there is none, and
/// perhaps when it is not below `below`.
double distance_in_cone(const Cone&, const std::array<glm::dvec3, 3>& corners,
                        double below = std::numeric_limits<double>::infinity());

}  // namespace pellucid::geocube
