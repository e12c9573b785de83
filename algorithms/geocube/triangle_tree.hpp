#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

namespace pellucid::geocube {

inline constexpr std::uint32_t kNoTriangle = ~0U;
inline constexpr double kConeSlack = 0.03;

/// A circular cone without a base: the points whose direction from `apex` is within the half-angle of `axis`.
struct Cone {
  glm::dvec3 apex{0.0};
  glm::dvec3 axis{0.0, 0.0, 1.0};  ///< unit
  double cosine = 1;               ///< of the half-angle, in [0, 1]
  double sine = 0;
};

struct Nearest {
  double distance = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = kNoTriangle;
};

/// Triangles in a binary tree of boxes, for the questions that rays do not answer: what is nearest, what lies in a
/// cone, what cuts what.
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
  struct Node {  // half a cache line
    glm::vec3 centre{0.0F};
    std::uint32_t first =
        0;                 ///< of the leaf's triangles in order_, or the right child; the left one follows its parent
    glm::vec3 half{0.0F};  ///< the box's half edges, rounded up
    std::uint32_t count = 0;  ///< 0: an inner node
  };
  void build(std::uint32_t begin, std::uint32_t end, const std::vector<glm::dvec3>& centroids);
  bool crosses(std::uint32_t a, std::uint32_t b) const;
  template <class Meets, class Distance>
  void nearest_first(const glm::vec3& from, double slack, Nearest& best, Meets, Distance) const;

  std::vector<glm::dvec3> positions_;
  std::vector<glm::uvec3> triangles_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
  double spread_ = 0;  ///< the largest coordinate
};

/// Distance from the origin to the nearest point of a triangle.
double distance_to_triangle(const std::array<glm::dvec3, 3>& corners);

/// Distance from the cone's apex to the nearest point of the triangle in the cone; infinite when there is none, and
/// perhaps when it is not below `below`.
double distance_in_cone(const Cone&, const std::array<glm::dvec3, 3>& corners,
                        double below = std::numeric_limits<double>::infinity());

}  // namespace pellucid::geocube
