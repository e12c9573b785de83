#include "algorithms/geocube/cones/triangle_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace pellucid::geocube {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRoundedUp = 1 + 1e-9;  // times a distance: above it, however that was rounded

// The plane through the apex that touches the cone's wall on the side of w, by its normal away from the cone.
glm::dvec3 wall_normal(const Cone& cone, const glm::dvec3& w) {
  const glm::dvec3 across = w - glm::dot(w, cone.axis) * cone.axis;
  const double length = glm::length(across);
  return (length > 0 ? cone.cosine / length * across : glm::dvec3(0.0)) - cone.sine * cone.axis;
}

bool in_cone(const Cone& cone, const glm::dvec3& from_apex) {
  return glm::dot(from_apex, cone.axis) >= cone.cosine * glm::length(from_apex);
}

// The nearest point to the apex on the part of the segment that the (convex) cone holds; perhaps infinite when it is
// not below `below`.
double distance_on_segment(const Cone& cone, const glm::dvec3& from, const glm::dvec3& to, double below) {
  const glm::dvec3 d = to - from;
  const double length2 = squared(d);
  if (length2 <= 0) return in_cone(cone, from) ? glm::length(from) : kInfinity;
  const double foot = -glm::dot(from, d) / length2;
  if (squared(from + std::clamp(foot, 0.0, 1.0) * d) >= below * below * kRoundedUp) return kInfinity;
  // The cone's wall: (p·a)² = cos²·p² for p = from + t·d.
  const double fa = glm::dot(from, cone.axis), da = glm::dot(d, cone.axis), cos2 = cone.cosine * cone.cosine;
  const double a = da * da - cos2 * length2;
  const double b = fa * da - cos2 * glm::dot(from, d);
  const double c = fa * fa - cos2 * squared(from);
  std::array<double, 4> stops{0.0, 1.0, 1.0, 1.0};
  std::size_t count = 1;
  const auto add = [&](double t) {
    if (t > 0 && t < 1) stops[count++] = t;
  };
  const double discriminant = b * b - a * c;
  if (discriminant >= 0) {
    const double q = -(b + std::copysign(std::sqrt(discriminant), b));
    if (a != 0) add(q / a);
    if (q != 0) add(c / q);
  }
  stops[count++] = 1.0;
  if (count == 4 && stops[1] > stops[2]) std::swap(stops[1], stops[2]);
  double best = kInfinity;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    if (!in_cone(cone, from + 0.5 * (stops[i] + stops[i + 1]) * d)) continue;
    best = std::min(best, squared(from + std::clamp(foot, stops[i], stops[i + 1]) * d));
  }
  return std::sqrt(best);
}

bool inside_triangle(const glm::dvec3& p, const std::array<glm::dvec3, 3>& t, const glm::dvec3& normal) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (glm::dot(glm::cross(t[(i + 1) % 3] - t[i], p - t[i]), normal) < 0) return false;
  }
  return true;
}

}  // namespace

double distance_to_triangle(const std::array<glm::dvec3, 3>& t) {
  const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double area2 = squared(normal);
  if (area2 > 0) {
    const glm::dvec3 foot = glm::dot(t[0], normal) / area2 * normal;
    if (inside_triangle(foot, t, normal)) return glm::length(foot);
  }
  double best = kInfinity;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 &from = t[i], d = t[(i + 1) % 3] - t[i];
    const double length2 = squared(d);
    const double at = length2 > 0 ? std::clamp(-glm::dot(from, d) / length2, 0.0, 1.0) : 0.0;
    best = std::min(best, squared(from + at * d));
  }
  return std::sqrt(best);
}

double distance_in_cone(const Cone& cone, const std::array<glm::dvec3, 3>& corners, double below) {
  const std::array<glm::dvec3, 3> t{corners[0] - cone.apex, corners[1] - cone.apex, corners[2] - cone.apex};
  const glm::dvec3 wall = wall_normal(cone, t[0] + t[1] + t[2]);
  if (glm::dot(wall, t[0]) > 0 && glm::dot(wall, t[1]) > 0 && glm::dot(wall, t[2]) > 0) return kInfinity;
  const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double area = glm::length(normal);
  if (std::abs(glm::dot(t[0], normal)) >= below * area && area > 0) return kInfinity;
  if (area > 0) {
    // In the triangle's plane the cone cuts out a convex region, symmetric about the axis's projection; its point
    // nearest to the apex lies in the cone's direction that is closest to the plane's normal.
    glm::dvec3 n = normal / area;
    double height = glm::dot(t[0], n);
    if (height < 0) {
      n = -n;
      height = -height;
    }
    const double along = glm::dot(cone.axis, n);
    glm::dvec3 direction = n;
    if (along < cone.cosine) {
      const glm::dvec3 across = n - along * cone.axis;
      const double length = glm::length(across);
      direction = length > 0 ? cone.cosine * cone.axis + cone.sine / length * across : cone.axis;
    }
    const double descent = glm::dot(direction, n);
    // Nothing of the plane is nearer, whatever part of it the triangle is; but for rounding.
    if (descent > 0 && height >= below * kRoundedUp * descent) return kInfinity;
    if (descent > 0 && inside_triangle(height / descent * direction, t, normal)) return height / descent;
  }
  double best = kInfinity;
  for (std::size_t i = 0; i < 3; ++i)
    best = std::min(best, distance_on_segment(cone, t[i], t[(i + 1) % 3], below));
  return best;
}

}  // namespace pellucid::geocube
