#include "algorithms/reference/ray_shadows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace pellucid {
namespace {

// The least sine between ray and light that still spans a plane.
constexpr double kLeastSine = 1e-7;
// Triangles that share an edge give the same end to the last bits; gaps below this share of the ray's part are closed.
constexpr double kShadowGap = 1e-12;

// g·x + c.
struct Affine {
  glm::dvec3 g{0.0};
  double c = 0.0;

  double operator()(const glm::dvec3& x) const { return glm::dot(g, x) + c; }
  // How far it departs from its value at the centre in a box of half the sides `half`.
  double reach(const glm::dvec3& half) const { return glm::dot(glm::abs(g), half); }
  Affine operator+(const Affine& o) const { return {g + o.g, c + o.c}; }
  Affine operator*(double k) const { return {k * g, k * c}; }
};

// The shadows found so far on t in [0, length], rising and apart.
class Union {
 public:
  Union(double length, std::vector<Interval>& parts)
      : length_(length), gap_(kShadowGap * length), parts_(parts), first_(parts.size()) {}

  bool empty() const { return parts_.size() == first_; }
  bool complete() const { return covers(0.0, length_); }

  bool covers(double begin, double end) const {
    const auto after = first_ending_after(begin);
    return after != parts_.end() && after->begin <= begin && end <= after->end;
  }

  void add(double begin, double end) {
    begin = std::max(begin, 0.0);
    end = std::min(end, length_);
    if (!(end > begin)) return;
    // Those that end before it stay, those that begin after it stay; what touches it becomes one with it.
    const auto low = std::partition_point(parts_.begin() + static_cast<std::ptrdiff_t>(first_), parts_.end(),
                                          [&](const Interval& part) { return part.end < begin - gap_; });
    auto high = low;
    for (; high != parts_.end() && high->begin <= end + gap_; ++high) {
      begin = std::min(begin, high->begin);
      end = std::max(end, high->end);
    }
    if (low == high) {
      parts_.insert(low, {begin, end});
    } else {
      *low = {begin, end};
      parts_.erase(low + 1, high);
    }
  }

  // From t to distances along the ray.
  void shift(double by) {
    for (std::size_t i = first_; i < parts_.size(); ++i)
      parts_[i] = {parts_[i].begin + by, parts_[i].end + by};
  }

 private:
  std::vector<Interval>::const_iterator first_ending_after(double t) const {
    return std::partition_point(parts_.cbegin() + static_cast<std::ptrdiff_t>(first_), parts_.cend(),
                                [&](const Interval& part) { return part.end < t; });
  }

  double length_, gap_;
  std::vector<Interval>& parts_;
  std::size_t first_;
};

// The plane piece between a part of a ray and a light, in a mesh's space. Its points are x = o + α d + β e, with d
// along the ray and e from its beginning to the light, and cast their shadow on o + t d at t = α / (1 − w β); w is 1,
// or 0 for a directional light. α and β are affine in x, and stay the same under affine transforms.
class Sheet {
 public:
  Sheet(const glm::dvec3& o, const glm::dvec3& d, const glm::dvec3& e, double w, double length)
      : length_(length), w_(w) {
    const glm::dvec3 n = glm::cross(d, e);
    const double n2 = glm::dot(n, n);
    const auto through_o = [&](const glm::dvec3& g) { return Affine{g, -glm::dot(g, o)}; };
    gamma_ = through_o(n);
    alpha_ = through_o(glm::cross(e, n) / n2);
    beta_ = through_o(glm::cross(n, d) / n2);
    // t ≥ 0 and t ≤ length, times 1 − w β.
    before_end_ = Affine{glm::dvec3(0.0), length} + beta_ * (-w * length) + alpha_ * -1.0;
  }

  // False only if the box has nothing to add.
  bool touches(const Box& box, const Union& found) const {
    const glm::dvec3 low(box.low), high(box.high);
    const glm::dvec3 centre = 0.5 * (low + high), half = 0.5 * (high - low);
    if (std::abs(gamma_(centre)) > gamma_.reach(half)) return false;
    const double beta = beta_(centre), beta_reach = beta_.reach(half);
    if (beta + beta_reach < 0.0) return false;
    const double alpha = alpha_(centre), alpha_reach = alpha_.reach(half);
    if (alpha + alpha_reach < 0.0) return false;
    if (before_end_(centre) + before_end_.reach(half) < 0.0) return false;
    if (found.empty()) return true;
    // A share that falls on known shadow adds nothing.
    const double least = 1.0 - w_ * (beta + beta_reach), most = 1.0 - w_ * (beta - beta_reach);
    if (least <= 0.0) return !found.complete();
    const double from = std::max(alpha - alpha_reach, 0.0) / most, upto = (alpha + alpha_reach) / least;
    return !found.covers(from, std::min(upto, length_));
  }

  void cast(const glm::vec3 (&corner)[3], Union& found) const {
    glm::dvec3 x[3];
    double side[3];
    for (std::size_t i = 0; i < 3; ++i) {
      x[i] = glm::dvec3(corner[i]);
      side[i] = gamma_(x[i]);
    }
    const int above = (side[0] > 0.0 ? 1 : 0) + (side[1] > 0.0 ? 1 : 0) + (side[2] > 0.0 ? 1 : 0);
    if (above == 0 || above == 3) return;

    glm::dvec2 end[2] = {glm::dvec2(0.0), glm::dvec2(0.0)};  // (α, β) where two of the edges pass through the plane
    std::size_t ends = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = i < 2 ? i + 1 : 0;
      if ((side[i] > 0.0) == (side[j] > 0.0)) continue;
      // Always from the side above, so that both triangles of an edge agree to the last bit.
      const std::size_t from = side[i] > 0.0 ? i : j, to = side[i] > 0.0 ? j : i;
      const glm::dvec3 p = glm::mix(x[from], x[to], side[from] / (side[from] - side[to]));
      end[ends++] = {alpha_(p), beta_(p)};
    }
    if (end[0].y < end[1].y) std::swap(end[0], end[1]);
    // Only what lies on the light's side of the ray: β ≥ 0.
    if (end[0].y < 0.0) return;
    if (end[1].y < 0.0) end[1] = glm::mix(end[1], end[0], end[1].y / (end[1].y - end[0].y));
    // And before the light: 1 − w β > 0.
    const double v0 = 1.0 - w_ * end[0].y, v1 = 1.0 - w_ * end[1].y;
    if (v1 <= 0.0) return;
    double t0;
    if (v0 > 0.0) {
      t0 = end[0].x / v0;
    } else {  // it passes the light's height, so its shadow goes on for ever
      const double alpha = glm::mix(end[1].x, end[0].x, v1 / (v1 - v0));
      t0 = std::copysign(std::numeric_limits<double>::infinity(), alpha);
    }
    const double t1 = end[1].x / v1;
    found.add(std::min(t0, t1), std::max(t0, t1));
  }

 private:
  double length_, w_;
  Affine alpha_, beta_, gamma_, before_end_;
};

glm::dvec3 perpendicular(const glm::dvec3& d) {
  const glm::dvec3 a = glm::abs(d);
  const glm::dvec3 axis = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                          : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                   : glm::dvec3(0, 0, 1);
  return glm::normalize(glm::cross(d, axis));
}

// The box of a transformed box, rounded outwards.
Box placed(const Box& box, const glm::dmat4& to_world) {
  const glm::dvec3 low(box.low), high(box.high);
  const glm::dvec3 centre(to_world * glm::dvec4(0.5 * (low + high), 1.0)), half = 0.5 * (high - low);
  const glm::dvec3 reach = glm::abs(glm::dvec3(to_world[0])) * half.x + glm::abs(glm::dvec3(to_world[1])) * half.y +
                           glm::abs(glm::dvec3(to_world[2])) * half.z;
  const glm::dvec3 rounding = 1e-6 * (glm::abs(centre) + reach);
  return {glm::vec3(centre - reach - rounding), glm::vec3(centre + reach + rounding)};
}

}  // namespace

RayShadows::MeshTree RayShadows::build(const Mesh& mesh) {
  std::vector<Box> boxes(mesh.triangles.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (int c = 0; c < 3; ++c)
      boxes[i].add(mesh.positions[mesh.triangles[i][c]]);
  }
  MeshTree result;
  result.tree = BoxTree(boxes);
  result.triangles.reserve(boxes.size());
  for (const std::uint32_t i : result.tree.order()) {
    const glm::uvec3& t = mesh.triangles[i];
    result.triangles.push_back({{mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]}});
  }
  return result;
}

RayShadows::RayShadows(const Scene& scene) : meshes_(scene.meshes.size()) {
  std::vector<char> used(scene.meshes.size(), 0);
  for (const Instance& instance : scene.instances)
    used[static_cast<std::size_t>(instance.mesh)] = 1;
  tbb::parallel_for(std::size_t{0}, meshes_.size(), [&](std::size_t i) {
    if (used[i] != 0) meshes_[i] = build(scene.meshes[i]);
  });
  std::vector<Box> boxes;
  std::vector<Placed> instances;
  for (const Instance& instance : scene.instances) {
    const auto mesh = static_cast<std::size_t>(instance.mesh);
    if (scene.meshes[mesh].triangles.empty()) continue;
    const glm::dmat4 to_world(instance.to_world);
    boxes.push_back(placed(meshes_[mesh].tree.bounds(), to_world));
    instances.push_back({mesh, glm::inverse(to_world)});
  }
  tree_ = BoxTree(boxes);
  for (const std::uint32_t i : tree_.order())
    instances_.push_back(instances[i]);
}

void RayShadows::find(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& part,
                      const glm::dvec4& light, std::vector<Interval>& shadows) const {
  const double length = part.end - part.begin;
  if (!(length > 0.0)) return;
  const glm::dvec3 start = origin + part.begin * direction;
  glm::dvec3 to_light = glm::dvec3(light) - light.w * start;
  const double distance = light.w > 0.0 ? std::max(glm::length(to_light), length) : 1.0;
  if (glm::length(glm::cross(direction, to_light)) < kLeastSine * distance) {
    to_light += kLeastSine * distance * perpendicular(direction);
  }
  Union found(length, shadows);
  const Sheet in_world(start, direction, to_light, light.w, length);
  tree_.traverse([&](const Box& box) { return in_world.touches(box, found); },
                 [&](std::size_t first, std::size_t last) {
                   for (std::size_t i = first; i < last; ++i) {
                     const Placed& instance = instances_[i];
                     const MeshTree& mesh = meshes_[instance.mesh];
                     const glm::dmat3 turn(instance.to_mesh);
                     const Sheet sheet(glm::dvec3(instance.to_mesh * glm::dvec4(start, 1.0)), turn * direction,
                                       turn * to_light, light.w, length);
                     mesh.tree.traverse([&](const Box& box) { return sheet.touches(box, found); },
                                        [&](std::size_t begin, std::size_t end) {
                                          for (std::size_t k = begin; k < end; ++k)
                                            sheet.cast(mesh.triangles[k].corner, found);
                                        });
                   }
                 });
  found.shift(part.begin);
}

}  // namespace pellucid
