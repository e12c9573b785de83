#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/geocube/cones/lanes.hpp"
#include "algorithms/geocube/cones/triangle_distance.hpp"

namespace pellucid::geocube {

inline constexpr std::uint32_t kNoTriangle = ~0U;

struct Nearest {
  double distance = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = kNoTriangle;
};

/// Triangles in a tree of boxes, four to a node, for the questions that rays do not answer: what is nearest, what lies
/// in a cone, what cuts what.
class TriangleTree {
 public:
  TriangleTree() = default;
  TriangleTree(std::vector<glm::dvec3> positions, std::vector<glm::uvec3> triangles);

  /// The point of the surface nearest to `point`.
  Nearest nearest(const glm::dvec3& point) const;

  /// The point of the surface nearest to the apex among those in the cone. Triangle `own`, which holds the apex, is
  /// left out where it leans away from the cone. `hint` is a triangle likely to be near (of a neighbouring query).
  Nearest nearest_in_cone(const Cone&, std::uint32_t own, std::uint32_t hint = kNoTriangle) const;

  /// Two triangles that cross each other in more than the corners or the edge that they share; kNoTriangle twice when
  /// there are none. If several pairs tie, the one with the smallest numbers.
  std::pair<std::uint32_t, std::uint32_t> first_crossing() const;

  std::span<const glm::dvec3> positions() const { return positions_; }
  std::span<const glm::uvec3> triangles() const { return triangles_; }
  std::array<glm::dvec3, 3> corners(std::uint32_t triangle) const {
    const glm::uvec3& t = triangles_[triangle];
    return {positions_[t.x], positions_[t.y], positions_[t.z]};
  }

 private:
  /// A node's four children side by side: the triangles of each lie in a box and between two parallel planes, which a
  /// piece of a smooth surface nearly fills.
  struct Node {
    FourVectorsKept centre, half;  ///< of the box; the half edges are rounded up
    FourVectorsKept normal;        ///< unit, of the planes
    FourKept offset, thickness;    ///< the planes lie at offset ± thickness from the box's centre
    std::array<std::uint32_t, 4> child{kNoTriangle, kNoTriangle, kNoTriangle, kNoTriangle};  ///< kTriangle: a triangle
    std::uint32_t triangles = 0, nodes = 0;  ///< which children are such, a bit for each
  };
  static constexpr std::uint32_t kTriangle = 1U << 31U;

  std::uint32_t build(std::span<std::uint32_t> order, const std::vector<glm::dvec3>& centroids);
  void enclose(Node&, std::size_t lane, std::span<const std::uint32_t> triangles) const;
  bool crosses(std::uint32_t a, std::uint32_t b) const;
  template <class Bound, class Distance>
  void nearest_first(Nearest& best, Bound, Distance) const;
  template <class Bound, class Distance>
  void nearer(Nearest& best, Bound, Distance) const;

  std::vector<glm::dvec3> positions_;
  std::vector<glm::uvec3> triangles_;
  std::vector<Node> nodes_;  // the root first
  double spread_ = 0;        // the largest coordinate
};

}  // namespace pellucid::geocube
