#include "algorithms/geocube/triangle_tree.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <numeric>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace pellucid::geocube {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kLeaf = 2;

double squared(const glm::dvec3& v) {
  return glm::dot(v, v);
}

float squared_distance_to_box(const glm::vec3& w, const glm::vec3& half) {
  const glm::vec3 d = glm::max(glm::abs(w) - half, 0.0F);
  return glm::dot(d, d);
}

// The plane through the apex that touches the cone's wall on the side of w, by its normal away from the cone.
glm::dvec3 wall_normal(const Cone& cone, const glm::dvec3& w) {
  const glm::dvec3 across = w - glm::dot(w, cone.axis) * cone.axis;
  const double length = glm::length(across);
  return (length > 0 ? cone.cosine / length * across : glm::dvec3(0.0)) - cone.sine * cone.axis;
}

/// A cone in single precision, for the boxes of a tree.
struct CoarseCone {
  glm::vec3 apex, axis;
  float cosine, sine;
  explicit CoarseCone(const Cone& c)
      : apex(c.apex), axis(c.axis), cosine(static_cast<float>(c.cosine)), sine(static_cast<float>(c.sine)) {}

  // False when the plane that touches the cone towards the box's middle parts the two.
  bool may_meet(const glm::vec3& w, const glm::vec3& half) const {
    const float along = glm::dot(w, axis);
    const glm::vec3 across = w - along * axis;
    const float length2 = glm::dot(across, across);
    if (length2 <= 0.0F) return true;
    const float length = std::sqrt(length2);
    const glm::vec3 n = cosine / length * across - sine * axis;
    return cosine * length - sine * along <= glm::dot(glm::abs(n), half);
  }
};

bool in_cone(const Cone& cone, const glm::dvec3& from_apex) {
  return glm::dot(from_apex, cone.axis) >= cone.cosine * glm::length(from_apex);
}

// The nearest point to the apex on the part of the segment that the (convex) cone holds.
double distance_on_segment(const Cone& cone, const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 d = to - from;
  const double length2 = squared(d);
  if (length2 <= 0) return in_cone(cone, from) ? glm::length(from) : kInfinity;
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
  const double foot = -glm::dot(from, d) / length2;
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

// Six times the signed volume of a tetrahedron.
double orient(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
  return glm::dot(glm::cross(b - a, c - a), d - a);
}

// True if the open segment passes through the open triangle; touching does not count.
bool pierces(const glm::dvec3& p, const glm::dvec3& q, const std::array<glm::dvec3, 3>& t) {
  const double above = orient(t[0], t[1], t[2], p), below = orient(t[0], t[1], t[2], q);
  // Differences of doubles that were floats: what is below this is rounding.
  const double scale = squared(t[1] - t[0]) + squared(t[2] - t[0]) + squared(q - p);
  const double least = 1e-12 * scale * std::sqrt(scale);
  if (!(above > least && below < -least) && !(above < -least && below > least)) return false;
  const double u = orient(p, q, t[0], t[1]), v = orient(p, q, t[1], t[2]), w = orient(p, q, t[2], t[0]);
  return (u > least && v > least && w > least) || (u < -least && v < -least && w < -least);
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
    if (descent > 0 && inside_triangle(height / descent * direction, t, normal)) return height / descent;
  }
  double best = kInfinity;
  for (std::size_t i = 0; i < 3; ++i)
    best = std::min(best, distance_on_segment(cone, t[i], t[(i + 1) % 3]));
  return best;
}

TriangleTree::TriangleTree(std::vector<glm::dvec3> positions, std::vector<glm::uvec3> triangles)
    : positions_(std::move(positions)), triangles_(std::move(triangles)), order_(triangles_.size()) {
  if (triangles_.empty()) return;
  std::iota(order_.begin(), order_.end(), 0U);
  std::vector<glm::dvec3> centroids(triangles_.size());
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
    const auto t = corners(i);
    centroids[i] = (t[0] + t[1] + t[2]) / 3.0;
  }
  nodes_.reserve(triangles_.size());
  for (const glm::dvec3& p : positions_)
    spread_ = std::max({spread_, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  build(0, static_cast<std::uint32_t>(triangles_.size()), centroids);
}

void TriangleTree::build(std::uint32_t begin, std::uint32_t end, const std::vector<glm::dvec3>& centroids) {
  const std::size_t at = nodes_.size();
  nodes_.emplace_back();
  glm::dvec3 low(kInfinity), high(-kInfinity), from(kInfinity), to(-kInfinity);
  for (std::uint32_t i = begin; i < end; ++i) {
    for (const glm::dvec3& p : corners(order_[i])) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    from = glm::min(from, centroids[order_[i]]);
    to = glm::max(to, centroids[order_[i]]);
  }
  const glm::dvec3 middle_of = 0.5 * (low + high);
  nodes_[at].centre = glm::vec3(middle_of);
  // Rounding of the centre, and of what single-precision queries do with it.
  nodes_[at].half = glm::vec3(0.5 * (high - low) + 1e-6 * (glm::abs(middle_of) + spread_));
  if (end - begin <= kLeaf) {
    nodes_[at].first = begin;
    nodes_[at].count = end - begin;
    return;
  }
  const glm::dvec3 extent = to - from;
  const int axis = extent.x >= extent.y ? (extent.x >= extent.z ? 0 : 2) : (extent.y >= extent.z ? 1 : 2);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) { return centroids[a][axis] < centroids[b][axis]; });
  build(begin, middle, centroids);
  nodes_[at].first = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end, centroids);
}

template <class Meets, class Distance>
void TriangleTree::nearest_first(const glm::vec3& from, double slack, Nearest& best, Meets meets,
                                 Distance distance) const {
  struct Waiting {
    std::uint32_t node;
    float distance2;
  };
  std::array<Waiting, 64> stack{};
  std::size_t depth = 0;
  const auto may_better = [&](float d2) {
    return static_cast<double>(d2) < slack * slack * best.distance * best.distance;
  };
  const auto push = [&](std::uint32_t at) {
    const Node& node = nodes_[at];
    const glm::vec3 w = node.centre - from;
    const float d2 = squared_distance_to_box(w, node.half);
    if (may_better(d2) && meets(w, node.half)) stack[depth++] = {at, d2};
  };
  if (!nodes_.empty()) push(0);
  while (depth > 0) {
    const Waiting waiting = stack[--depth];
    if (!may_better(waiting.distance2)) continue;
    const Node& node = nodes_[waiting.node];
    if (node.count == 0) {
      const std::size_t base = depth;
      push(waiting.node + 1);
      push(node.first);
      if (depth == base + 2 && stack[base].distance2 < stack[base + 1].distance2)
        std::swap(stack[base], stack[base + 1]);
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const double d = distance(order_[i], best.distance);
      if (d < best.distance) best = {d, order_[i]};
    }
  }
}

Nearest TriangleTree::nearest(const glm::dvec3& point) const {
  Nearest best;
  nearest_first(
      glm::vec3(point), 1, best, [](const glm::vec3&, const glm::vec3&) { return true; },
      [&](std::uint32_t triangle, double) {
        auto t = corners(triangle);
        for (glm::dvec3& p : t)
          p -= point;
        return distance_to_triangle(t);
      });
  return best;
}

Nearest TriangleTree::nearest_in_cone(const Cone& cone, std::uint32_t own, std::uint32_t hint) const {
  Nearest best;
  if (own != kNoTriangle) {
    // The cone's directions nearest to the own plane make the angle θ with the axis: it leans away when all others do.
    const auto t = corners(own);
    const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
    if (std::abs(glm::dot(normal, cone.axis)) <= cone.sine * glm::length(normal) * (1 - 1e-9)) return {0.0, own};
  }
  if (hint != kNoTriangle && hint != own) best = {distance_in_cone(cone, corners(hint)), hint};
  const CoarseCone coarse(cone);
  nearest_first(
      coarse.apex, 1 - kConeSlack, best,
      [&](const glm::vec3& w, const glm::vec3& half) { return coarse.may_meet(w, half); },
      [&](std::uint32_t triangle, double below) {
        return triangle == own ? kInfinity : distance_in_cone(cone, corners(triangle), below);
      });
  best.distance *= 1 - kConeSlack;
  return best;
}

bool TriangleTree::crosses(std::uint32_t a, std::uint32_t b) const {
  const glm::uvec3 &ta = triangles_[a], &tb = triangles_[b];
  int shared = 0;
  std::array<bool, 3> in_a{}, in_b{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (ta[i] != tb[j]) continue;
      ++shared;
      in_a[static_cast<std::size_t>(i)] = in_b[static_cast<std::size_t>(j)] = true;
    }
  }
  if (shared >= 2) return false;
  const auto ca = corners(a), cb = corners(b);
  for (std::size_t i = 0; i < 3; ++i) {
    // An edge that holds the shared corner ends on the other triangle and cannot pierce it besides.
    const std::size_t j = (i + 1) % 3;
    if (!in_a[i] && !in_a[j] && pierces(ca[i], ca[j], cb)) return true;
    if (!in_b[i] && !in_b[j] && pierces(cb[i], cb[j], ca)) return true;
  }
  return false;
}

std::pair<std::uint32_t, std::uint32_t> TriangleTree::first_crossing() const {
  std::atomic<std::uint64_t> first{~std::uint64_t{0}};
  const auto count = static_cast<std::uint32_t>(triangles_.size());
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, count, 1024), [&](const auto& range) {
    std::array<std::uint32_t, 64> stack{};
    for (std::uint32_t a = range.begin(); a != range.end(); ++a) {
      const auto t = corners(a);
      const glm::dvec3 low = glm::min(glm::min(t[0], t[1]), t[2]), high = glm::max(glm::max(t[0], t[1]), t[2]);
      const glm::dvec3 middle = 0.5 * (low + high), half = 0.5 * (high - low);
      std::size_t depth = 0;
      stack[depth++] = 0;
      while (depth > 0) {
        const std::uint32_t at = stack[--depth];
        const Node& node = nodes_[at];
        if (glm::any(glm::greaterThan(glm::abs(glm::dvec3(node.centre) - middle) - half, glm::dvec3(node.half))))
          continue;
        if (node.count == 0) {
          stack[depth++] = node.first;
          stack[depth++] = at + 1;
          continue;
        }
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
          const std::uint32_t b = order_[i];
          if (b <= a || !crosses(a, b)) continue;
          const std::uint64_t pair = (std::uint64_t{a} << 32U) | b;
          std::uint64_t known = first.load();
          while (pair < known && !first.compare_exchange_weak(known, pair)) {
          }
        }
      }
    }
  });
  const std::uint64_t pair = first.load();
  return {static_cast<std::uint32_t>(pair >> 32U), static_cast<std::uint32_t>(pair & 0xffffffffU)};
}

}  // namespace pellucid::geocube
