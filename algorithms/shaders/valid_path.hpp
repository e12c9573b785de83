#pragma once

#include <algorithm>

#include <glm/glm.hpp>

/// The valid sampling path of a viewing ray in a hull (Imagire et al. 2007, Sec. 3.2). GLSL twin:
/// shaders/valid_path.glsl.
namespace pellucid {

/// Length [m] of the path from s to s^F along the unit viewing ray; 0 where rounding put s before s^F.
inline double valid_path_length(const glm::dvec3& s_world, const glm::dvec3& sf_world, const glm::dvec3& ray) {
  return std::max(glm::dot(s_world - sf_world, ray), 0.0);
}

/// Eq. 1 and 2: distance [m] behind s^F of the i-th of `count` points.
inline double sample_distance(double path_length_m, double i, double count, double offset) {
  return path_length_m * (1 - (i + offset) / count);
}

/// Eq. 3: the same for the half-way point behind the i-th point, or with i = count before the last one; held on the
/// path.
inline double half_way_distance(double path_length_m, double i, double count, double offset) {
  return std::clamp(sample_distance(path_length_m, i - 0.5, count, offset), 0.0, path_length_m);
}

}  // namespace pellucid
