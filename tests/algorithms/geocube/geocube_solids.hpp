#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>

#include <glm/glm.hpp>

#include "algorithms/scene/noise.hpp"
#include "algorithms/scene/scene.hpp"
#include "algorithms/scene/shapes/procedural.hpp"

/// Closed meshes with known answers.
namespace pellucid::test {

/// A radius by direction, as a triangle mesh with smooth normals from the gradient of |p| − r(p/|p|): segments² · 12
/// triangles over a cube's faces.
inline Mesh make_radial(const std::function<double(const glm::dvec3&)>& radius, int segments) {
  Mesh mesh;
  mesh.name = "radial";
  const auto point = [&](const glm::dvec3& d) {
    const glm::dvec3 u = glm::normalize(d);
    return radius(u) * u;
  };
  const auto gradient = [&](const glm::dvec3& p) {
    glm::dvec3 g(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 step(0.0);
      step[axis] = 1e-5;
      const auto field = [&](const glm::dvec3& q) { return glm::length(q) - radius(glm::normalize(q)); };
      g[axis] = (field(p + step) - field(p - step)) / 2e-5;
    }
    return glm::normalize(g);
  };
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const double sign = face % 2 == 0 ? 1 : -1;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int j = 0; j <= segments; ++j) {
      for (int i = 0; i <= segments; ++i) {
        glm::dvec3 d(0.0);
        d[axis] = sign;
        d[(axis + 1) % 3] = sign * std::tan((2.0 * i / segments - 1) * std::numbers::pi / 4);
        d[(axis + 2) % 3] = std::tan((2.0 * j / segments - 1) * std::numbers::pi / 4);
        const glm::dvec3 p = point(d);
        mesh.positions.emplace_back(p);
        mesh.normals.emplace_back(gradient(p));
      }
    }
    const auto row = static_cast<std::uint32_t>(segments + 1);
    for (std::uint32_t j = 0; j < row - 1; ++j) {
      for (std::uint32_t i = 0; i < row - 1; ++i) {
        const std::uint32_t a = first + j * row + i;
        mesh.triangles.emplace_back(a, a + 1, a + row + 1);
        mesh.triangles.emplace_back(a, a + row + 1, a + row);
      }
    }
  }
  return mesh;
}

inline double ellipsoid_radius(const glm::dvec3& u, const glm::dvec3& axes) {
  return 1 / glm::length(u / axes);
}

/// The radius of the scene's shape as it is by default: three lobes about the y axis.
inline double star_radius(const glm::dvec3& u) {
  return pellucid::star_radius({}, u);
}

inline glm::dvec3 random_direction(Random& random) {
  const double z = 2 * static_cast<double>(random.next()) - 1;
  const double turn = 2 * std::numbers::pi * static_cast<double>(random.next());
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

}  // namespace pellucid::test
