#include "algorithms/geocube/cones/triangle_tree.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace pellucid::geocube {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr float kFarAway = std::numeric_limits<float>::infinity();

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

/// Four boxes with their planes, seen from a point.
struct Seen {
  FourVectors from;  ///< to the box's centre
  FourVectors half;
  FourVectors normal;
  Four height;  ///< of the middle between the planes
  Four thickness;
  template <class Node>
  Seen(const Node& node, const glm::vec3& point)
      : from(FourVectors(node.centre).minus(point)),
        half(node.half),
        normal(node.normal),
        height(dot(normal, from) + Four(node.offset)),
        thickness(node.thickness) {}

  [[gnu::always_inline]] Four distance_to_box() const {
    const Four zero = 0;
    return length({stdx::max(stdx::abs(from.x) - half.x, zero), stdx::max(stdx::abs(from.y) - half.y, zero),
                   stdx::max(stdx::abs(from.z) - half.z, zero)});
  }
};

/// A cone in single precision, for the boxes of a tree.
struct CoarseCone {
  glm::vec3 apex, axis;
  float cosine, sine;
  explicit CoarseCone(const Cone& c)
      : apex(c.apex), axis(c.axis), cosine(static_cast<float>(c.cosine)), sine(static_cast<float>(c.sine)) {}

  // True when the plane that touches the cone towards a box's middle parts the two.
  [[gnu::always_inline]] FourFlags misses(const Seen& seen) const {
    const FourVectors plane = touching_normal(seen.from, axis, cosine, sine);
    return dot(plane, seen.from) > dot(abs(plane), seen.half);
  }

  // How far from the apex the cone's points between the planes begin and end, at least and at most.
  struct Span {
    Four begin, end;
  };
  [[gnu::always_inline]] Span between_planes(const Seen& seen) const {
    constexpr float kRounding = 1e-5F;
    // The normal is turned so that the planes lie on its side; in the cone the share of a way that goes along it is
    // between `least` and `most`, by the angle to the axis.
    Four slant = dot(seen.normal, axis);
    stdx::where(seen.height < 0, slant) = -slant;
    const Four height = stdx::abs(seen.height), low = height - seen.thickness, high = height + seen.thickness;
    const Four turned = sine * stdx::sqrt(stdx::max(1 - slant * slant, Four(0)));
    Four most = slant * cosine + turned, least = slant * cosine - turned;
    stdx::where(slant >= cosine, most) = 1;
    stdx::where(slant <= -cosine, least) = -1;
    most += kRounding;
    least -= kRounding;
    Span span{0, kFarAway};
    stdx::where(low > 0 && most > 0, span.begin) = low / most;
    stdx::where(low > 0 && most <= 0, span.begin) = kFarAway;
    stdx::where(least > 0, span.end) = high / least;
    stdx::where(most < 0, span.end) = stdx::max(low / most, Four(0));
    return span;
  }

  // A lower bound of the distance from the apex to the points of each box in the cone; infinite when there are none.
  [[gnu::always_inline]] Four distance(const Seen& seen) const {
    const Four box = seen.distance_to_box();
    const Span span = between_planes(seen);
    Four result = stdx::max(box, span.begin);
    stdx::where(box > span.end || misses(seen), result) = kFarAway;
    return result;
  }
};

// A bound from here on, rounding included, tells that nothing is nearer.
float far_bound(const Nearest& best) {
  return static_cast<float>(best.distance * (1 + 2e-6));
}

}  // namespace

TriangleTree::TriangleTree(std::vector<glm::dvec3> positions, std::vector<glm::uvec3> triangles)
    : positions_(std::move(positions)), triangles_(std::move(triangles)) {
  if (triangles_.empty()) return;
  std::vector<std::uint32_t> order(triangles_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::vector<glm::dvec3> centroids(triangles_.size());
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
    const auto t = corners(i);
    centroids[i] = (t[0] + t[1] + t[2]) / 3.0;
  }
  for (const glm::dvec3& p : positions_)
    spread_ = std::max({spread_, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  nodes_.reserve(triangles_.size() / 2 + 1);
  build(order, centroids);
}

// A node of these triangles, which it sorts into four parts of nearly the same number.
std::uint32_t TriangleTree::build(std::span<std::uint32_t> order, const std::vector<glm::dvec3>& centroids) {
  const auto halves = [&](std::span<std::uint32_t> part) {
    glm::dvec3 low(kUnbounded), high(-kUnbounded);
    for (const std::uint32_t triangle : part) {
      low = glm::min(low, centroids[triangle]);
      high = glm::max(high, centroids[triangle]);
    }
    const glm::dvec3 extent = high - low;
    const int axis = extent.x >= extent.y ? (extent.x >= extent.z ? 0 : 2) : (extent.y >= extent.z ? 1 : 2);
    const auto middle = static_cast<std::ptrdiff_t>(part.size() / 2);
    std::nth_element(part.begin(), part.begin() + middle, part.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return centroids[a][axis] < centroids[b][axis]; });
    return std::array{part.subspan(0, part.size() / 2), part.subspan(part.size() / 2)};
  };
  const auto at = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  std::size_t lane = 0;
  for (const auto& half : halves(order)) {
    for (const auto& part : halves(half)) {
      if (part.empty()) continue;
      enclose(nodes_[at], lane, part);
      const std::uint32_t child = part.size() == 1 ? part.front() | kTriangle : build(part, centroids);
      (part.size() == 1 ? nodes_[at].triangles : nodes_[at].nodes) |= 1U << lane;
      nodes_[at].child[lane++] = child;
    }
  }
  return at;
}

void TriangleTree::enclose(Node& node, std::size_t lane, std::span<const std::uint32_t> triangles) const {
  glm::dvec3 low(kUnbounded), high(-kUnbounded), normal(0.0);
  for (const std::uint32_t triangle : triangles) {
    const auto t = corners(triangle);
    for (const glm::dvec3& p : t) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
    normal += glm::cross(t[1] - t[0], t[2] - t[0]);
  }
  const glm::dvec3 centre = 0.5 * (low + high);
  // Rounding of the centre, and of what single-precision queries do with it.
  const double rounding = 1e-6 * spread_;
  node.centre.set(lane, centre);
  node.half.set(lane, 0.5 * (high - low) + 2 * rounding);
  const double length = glm::length(normal);
  if (!(length > 0)) {
    node.thickness[lane] = kFarAway;
    return;
  }
  double least = kUnbounded, most = -kUnbounded;
  for (const std::uint32_t triangle : triangles) {
    for (const glm::dvec3& p : corners(triangle)) {
      const double height = glm::dot(normal, p - centre) / length;
      least = std::min(least, height);
      most = std::max(most, height);
    }
  }
  node.normal.set(lane, normal / length);
  node.offset[lane] = static_cast<float>(0.5 * (least + most));
  node.thickness[lane] = static_cast<float>(0.5 * (most - least) + 4 * rounding);
}

// Depth first, the nearest child first; `bound(node)` tells how near its children's triangles are at least.
template <class Bound, class Distance>
void TriangleTree::nearest_first(Nearest& best, Bound bound, Distance distance) const {
  struct Waiting {
    float least = 0;
    std::uint32_t child = 0;
  };
  std::array<Waiting, 64> stack;
  std::size_t depth = 0;
  float within = far_bound(best);
  if (!nodes_.empty()) stack[depth++] = {0, 0};
  while (depth > 0) {
    const Waiting waiting = stack[--depth];
    if (!(waiting.least < within)) continue;
    if ((waiting.child & kTriangle) != 0) {
      const std::uint32_t triangle = waiting.child & ~kTriangle;
      const double d = distance(triangle, best.distance);
      if (d >= best.distance) continue;
      best = {d, triangle};
      within = far_bound(best);
      continue;
    }
    const Node& node = nodes_[waiting.child];
    const Four least = bound(node);
    const std::size_t base = depth;
    for (unsigned left = bits_of(least < within); left != 0; left &= left - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(left));
      if (node.child[k] == kNoTriangle) continue;
      std::size_t i = depth++;
      for (; i > base && stack[i - 1].least < least[k]; --i)
        stack[i] = stack[i - 1];
      stack[i] = {least[k], node.child[k]};
    }
  }
}

// The same where little or nothing is nearer than the best so far. The nodes' order is of no matter then, and they are
// taken by batches: no branch waits for a result, and the processor works at several nodes at a time.
template <class Bound, class Distance>
void TriangleTree::nearer(Nearest& best, Bound bound, Distance distance) const {
  constexpr std::size_t kBatch = 16;
  std::array<std::uint32_t, 1024> waiting;  // a batch leaves three times its number at most, once for each level
  std::array<std::uint32_t, kBatch> nodes;
  std::array<unsigned, kBatch> near;
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const float within = far_bound(best);
    const std::size_t batch = std::min(count, kBatch);
    count -= batch;
    assert(count + 4 * batch <= waiting.size());
    for (std::size_t i = 0; i < batch; ++i) {
      nodes[i] = waiting[count + i];
      near[i] = bits_of(bound(nodes_[nodes[i]]) < within);
    }
    for (std::size_t i = 0; i < batch; ++i) {
      const Node& node = nodes_[nodes[i]];
      for (unsigned left = near[i] & node.triangles; left != 0; left &= left - 1) {
        const std::uint32_t triangle = node.child[static_cast<std::size_t>(std::countr_zero(left))] & ~kTriangle;
        const double d = distance(triangle, best.distance);
        if (d < best.distance) best = {d, triangle};
      }
      for (std::size_t k = 0; k < 4; ++k) {
        waiting[count] = node.child[k];
        count += (near[i] & node.nodes) >> k & 1U;
      }
    }
  }
}

Nearest TriangleTree::nearest(const glm::dvec3& point) const {
  Nearest best;
  const glm::vec3 coarse(point);
  nearest_first(
      best,
      [&](const Node& node) {
        const Seen seen(node, coarse);
        return stdx::max(seen.distance_to_box(), stdx::abs(seen.height) - seen.thickness);
      },
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
  const auto bound = [&](const Node& node) { return coarse.distance(Seen(node, coarse.apex)); };
  const auto distance = [&](std::uint32_t triangle, double below) {
    return triangle == own ? kUnbounded : distance_in_cone(cone, corners(triangle), below);
  };
  if (best.distance < kUnbounded)
    nearer(best, bound, distance);
  else
    nearest_first(best, bound, distance);
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
      const glm::vec3 middle(0.5 * (low + high)), half(0.5 * (high - low));
      std::size_t depth = 0;
      stack[depth++] = 0;
      while (depth > 0) {
        const Node& node = nodes_[stack[--depth]];
        const FourVectors gap = abs(FourVectors(node.centre).minus(middle)).minus(half);
        const FourFlags apart = gap.x > Four(node.half.x) || gap.y > Four(node.half.y) || gap.z > Four(node.half.z);
        for (std::size_t k = 0; k < 4; ++k) {
          if (apart[k] || node.child[k] == kNoTriangle) continue;
          if ((node.child[k] & kTriangle) == 0) {
            stack[depth++] = node.child[k];
            continue;
          }
          const std::uint32_t b = node.child[k] & ~kTriangle;
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
