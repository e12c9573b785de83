#pragma once

#include <vector>

#include <glm/glm.hpp>

namespace pellucid {

struct Keyframe {
  double time_s = 0;
  glm::dvec3 value{0.0};
};

/// A curve through keyframes, at least two, their times rising.
struct MotionPath {
  enum class Interpolation { linear, catmull_rom };
  std::vector<Keyframe> keyframes;
  Interpolation interpolation = Interpolation::linear;
  /// The path begins again at its end (the last value equals the first); else it rests at its first value before it
  /// begins and at its last value after it has ended.
  bool loop = false;

  /// Catmull-Rom: a cubic Hermite curve whose tangent at a keyframe is the slope between its two neighbours; at an open
  /// end the slope to the only neighbour.
  glm::dvec3 at(double time_s) const;
};

/// A steady rotation about an axis through the object's own origin; right-handed.
struct Spin {
  glm::dvec3 axis{0.0, 1.0, 0.0};
  double deg_per_s = 0;
  glm::dmat3 at(double time_s) const;
};

/// Rotation by an angle about an axis that is not zero.
glm::dmat3 rotation(const glm::dvec3& axis, double angle_deg);

}  // namespace pellucid
