#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include <glm/glm.hpp>

/// OpenGL's cube map (4.5 core, Table 8.19), for whoever draws into one or reads one on the CPU.
namespace pellucid::gl {

/// A face's axes in the cube's space. Texel (s, t) ∈ [0, 1]² looks along `axis + (2s − 1) right + (2t − 1) up`; row 0
/// of a face as uploaded, read or drawn is t = 0.
struct CubeFace {
  glm::vec3 axis, right, up;
};
inline constexpr int kCubeFaces = 6;
inline constexpr std::array<CubeFace, kCubeFaces> kCubeFaceAxes{{{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
                                                                 {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                                                                 {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
                                                                 {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
                                                                 {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},
                                                                 {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}}}};

/// Where a direction, not zero, meets the cube.
struct CubeTexel {
  int face = 0;
  double s = 0, t = 0;  ///< in [0, 1]
};
inline CubeTexel cube_texel(const glm::dvec3& direction) {
  const glm::dvec3 a = glm::abs(direction);
  int face = 0;
  if (a.x >= a.y && a.x >= a.z)
    face = direction.x > 0 ? 0 : 1;
  else if (a.y >= a.z)
    face = direction.y > 0 ? 2 : 3;
  else
    face = direction.z > 0 ? 4 : 5;
  const CubeFace& axes = kCubeFaceAxes[static_cast<std::size_t>(face)];
  const double depth = glm::dot(direction, glm::dvec3(axes.axis));
  return {face, 0.5 + 0.5 * glm::dot(direction, glm::dvec3(axes.right)) / depth,
          0.5 + 0.5 * glm::dot(direction, glm::dvec3(axes.up)) / depth};
}

/// Not of unit length: its part along the face's axis is 1.
inline glm::dvec3 cube_direction(const CubeTexel& texel) {
  const CubeFace& axes = kCubeFaceAxes[static_cast<std::size_t>(texel.face)];
  return glm::dvec3(axes.axis) + (2 * texel.s - 1) * glm::dvec3(axes.right) + (2 * texel.t - 1) * glm::dvec3(axes.up);
}

/// World to clip space of one face of a cube about `center`, between two clipping planes [m].
inline glm::mat4 cube_face_to_clip(int face, const glm::vec3& center, float near_m, float far_m) {
  const CubeFace& axes = kCubeFaceAxes[static_cast<std::size_t>(face)];
  const auto row = [&](const glm::vec3& v) { return glm::vec4(v, -glm::dot(v, center)); };
  const glm::vec4 depth = row(axes.axis);
  const float scale = (far_m + near_m) / (far_m - near_m), shift = 2 * far_m * near_m / (far_m - near_m);
  const glm::mat4 rows(row(axes.right), row(axes.up), scale * depth - glm::vec4(0, 0, 0, shift), depth);
  return glm::transpose(rows);
}

}  // namespace pellucid::gl
