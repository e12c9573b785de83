#include "algorithms/local_cube_maps/star_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace pellucid::local_cube_maps {
namespace {

// Solid angle of a triangle about the origin, negative where it shows the origin its front (Van Oosterom and Strackee).
double solid_angle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double above = glm::dot(a, glm::cross(b, c));
  const double below = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
  return 2 * std::atan2(above, below);
}

struct Corners {
  glm::dvec3 a, b, c;
};
Corners corners(const Mesh& mesh, const glm::uvec3& t, const glm::dvec3& center) {
  return {glm::dvec3(mesh.positions[t.x]) - center, glm::dvec3(mesh.positions[t.y]) - center,
          glm::dvec3(mesh.positions[t.z]) - center};
}

}  // namespace

StarShape measure_star_shape(const Mesh& mesh, const glm::dvec3& center) {
  double area = 0, hidden = 0, folded = 0, total = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const auto [a, b, c] = corners(mesh, t, center);
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double size = 0.5 * glm::length(normal), angle = solid_angle(a, b, c);
    area += size;
    total += angle;
    if (glm::dot(normal, a) < 0) {
      hidden += size;
      folded -= angle;
    }
  }
  const double sphere = 4 * std::numbers::pi;
  StarShape result;
  if (area > 0) result.hidden_area = hidden / area;
  result.folded = std::max(folded, 0.0) / sphere;
  result.uncovered = std::clamp(1 - total / sphere, 0.0, 1.0);
  return result;
}

glm::vec3 choose_center(const Mesh& mesh) {
  if (mesh.positions.empty()) return glm::vec3(0);
  glm::vec3 low = mesh.positions.front(), high = low;
  for (const glm::vec3& p : mesh.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::dvec3 middle = 0.5 * (glm::dvec3(low) + glm::dvec3(high));
  // Centroid of the solid: of the tetrahedra between its triangles and any point, by their signed volumes.
  double volume = 0;
  glm::dvec3 moment(0);
  for (const glm::uvec3& t : mesh.triangles) {
    const auto [a, b, c] = corners(mesh, t, middle);
    const double part = glm::dot(a, glm::cross(b, c)) / 6;
    volume += part;
    moment += part * 0.25 * (a + b + c);
  }
  const glm::dvec3 size(high - low);
  const double box = size.x * size.y * size.z;
  if (volume < 1e-6 * box) return glm::vec3(middle);
  const glm::dvec3 centroid = middle + moment / volume;
  const auto fault = [&](const glm::dvec3& center) {
    const StarShape shape = measure_star_shape(mesh, center);
    return shape.folded + shape.uncovered;
  };
  return glm::vec3(fault(centroid) < fault(middle) ? centroid : middle);
}

bool closed(const Mesh& mesh) {
  // Vertices that share a place count as one, as on the seams of texture coordinates.
  std::vector<unsigned> order(mesh.positions.size()), same(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](unsigned i) {
    const glm::vec3 p = mesh.positions[i] + glm::vec3(0);  // −0 is 0
    return std::array<float, 3>{p.x, p.y, p.z};
  };
  std::sort(order.begin(), order.end(), [&](unsigned a, unsigned b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    same[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? same[order[i - 1]] : order[i];
  std::vector<std::pair<unsigned, unsigned>> edges, opposite;
  double volume = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const auto [a, b, c] = corners(mesh, t, glm::dvec3(0));
    volume += glm::dot(a, glm::cross(b, c));
    for (int i = 0; i < 3; ++i) {
      const unsigned from = same[t[i]], to = same[t[(i + 1) % 3]];
      if (from == to) continue;  // of a triangle without area
      edges.emplace_back(from, to);
      opposite.emplace_back(to, from);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::sort(opposite.begin(), opposite.end());
  return volume > 0 && edges == opposite;
}

std::string describe(const std::string& name, const StarShape& shape) {
  return fmt::format(
      "refractor '{}' is not star-shaped: {:.3g} % of its area faces its centre, {:.3g} % of the directions meet more "
      "than one layer of it and {:.3g} % none; the refractor map keeps the nearest",
      name, 100 * shape.hidden_area, 100 * shape.folded, 100 * shape.uncovered);
}

}  // namespace pellucid::local_cube_maps
