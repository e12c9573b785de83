#include "algorithms/reference/ray_tree.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "algorithms/shaders/optics.hpp"
#include "gl/error.hpp"

namespace pellucid {
namespace {

// Crossings that the search for a point's solids follows: more than any scene of ours has along a line.
constexpr int kMostCrossings = 100'000;

}  // namespace

void Solids::enter(int instance) {
  if (count_ == of_.size())
    throw RuntimeError(fmt::format("more than {} dielectrics lie inside one another along a ray", of_.size()));
  of_[count_++] = instance;
}

void Solids::leave(int instance) {
  // When solids overlap and do not nest, the outer one may be left first.
  const auto end = of_.begin() + static_cast<std::ptrdiff_t>(count_);
  const auto found = std::find(of_.begin(), end, instance);
  if (found == end) return;
  std::copy(found + 1, end, found);
  --count_;
}

bool Solids::contains(int instance) const {
  const auto end = of_.begin() + static_cast<std::ptrdiff_t>(count_);
  return std::find(of_.begin(), end, instance) != end;
}

glm::dvec3 RayTree::absorbed(const Branch& branch, double path_m) const {
  const glm::dvec3 absorption(material_of(*scene_, branch.inside.innermost()).absorption);
  glm::dvec3 left(1.0);
  for (int c = 0; c < 3; ++c) {
    if (absorption[c] > 0.0) left[c] = std::exp(-absorption[c] * path_m);  // an open solid's path is infinite
  }
  return left;
}

void RayTree::push(Branch child, const glm::dvec3& weight, const TreeLimits& limits, Scratch& scratch,
                   TreeTally& tally) const {
  const double share = worst(weight);
  if (share <= 0.0) return;
  child.weight = weight;
  if (child.depth > limits.depth) {
    tally.cut_weight += share;
    return;
  }
  if (share < limits.cut) {
    const double factor = limits.roulette ? limits.roulette(share) : 0.0;
    if (factor == 0.0) {
      if (!limits.roulette) tally.cut_weight += share;
      return;
    }
    child.weight *= factor;
  }
  scratch.push_back(child);
}

// On behind the triangle, as if it were not there.
void RayTree::pass(const Branch& parent, const Hit& hit, const SurfacePoint& point, Scratch& scratch) const {
  Branch child = parent;
  child.from = hit;
  child.start = point.position;
  child.face = -point.face;
  scratch.push_back(child);
}

void RayTree::branch(const Branch& parent, const Hit& hit, const SurfacePoint& point, const TreeLimits& limits,
                     Scratch& scratch, TreeTally& tally) const {
  const Material& material = material_of(*scene_, *hit.instance);
  Branch child = parent;
  child.from = hit;
  child.start = point.position;
  child.face = point.face;
  child.depth = parent.depth + 1;

  if (material.kind != SurfaceKind::dielectric) {
    const Bend bend = reflect_at(parent.direction, point.normal, point.face);
    child.direction = bend.reflected;
    glm::dvec3 share(material.reflectance);
    if (material.kind == SurfaceKind::metal)
      share *= fresnel_metal(bend.cosine, glm::dvec3(material.metal_n), glm::dvec3(material.metal_k));
    push(child, parent.weight * share, limits, scratch, tally);
    return;
  }

  // Shells of one mesh may overlap, so that it is entered twice; it is not left before.
  if (!point.front && !parent.inside.contains(hit.index)) tally.lost_weight += worst(parent.weight);
  if (!limits.both_sides && !point.front) {  // the far side is not there
    child.face = -point.face;
    child.inside.leave(hit.index);
    push(child, parent.weight, limits, scratch, tally);
    return;
  }
  const double ior = static_cast<double>(material.ior);
  const Split split = split_at(parent.direction, point.normal, point.face, point.front ? 1.0 / ior : ior);
  if (split.reflected_share > 0.0) {
    const glm::dvec3 weight = parent.weight * split.reflected_share;
    const bool allowed = point.front ? limits.entry_reflection : parent.reflections < limits.reflections;
    if (allowed) {
      child.direction = split.reflected;
      if (!point.front) ++child.reflections;
      push(child, weight, limits, scratch, tally);
    } else {
      tally.limited_weight += worst(weight);
    }
  }
  if (split.refracted) {
    child.direction = *split.refracted;
    child.face = -point.face;
    child.reflections = parent.reflections;
    if (point.front) {
      child.inside.enter(hit.index);
    } else {
      child.inside.leave(hit.index);
      if (child.inside.empty()) child.reflections = 0;
    }
    push(child, parent.weight * (1.0 - split.reflected_share), limits, scratch, tally);
  }
}

Solids RayTree::solids_at(const glm::dvec3& point) const {
  // Any direction will do that runs along no edge; of nested solids the innermost is left first.
  const glm::dvec3 direction = glm::normalize(glm::dvec3(0.5773, 0.6427, 0.5036));
  struct Crossing {
    int instance, inwards;
  };
  std::vector<Crossing> open;  // solids whose boundary was crossed, outwards more often than inwards: around the point
  std::vector<int> left;       // in the order in which they are left
  Hit hit = geometry_->intersect(point, direction, 0.0, std::numeric_limits<double>::infinity());
  glm::dvec3 origin = point;
  for (int i = 0; hit.instance != nullptr && i < kMostCrossings; ++i) {
    const SurfacePoint at = surface_at(*scene_, *geometry_, hit, origin, direction);
    if (material_of(*scene_, *hit.instance).kind == SurfaceKind::dielectric) {
      auto found = std::find_if(open.begin(), open.end(), [&](const Crossing& c) { return c.instance == hit.index; });
      if (found == open.end()) found = open.insert(open.end(), {hit.index, 0});
      found->inwards += at.front ? 1 : -1;
      if (found->inwards < 0 && std::find(left.begin(), left.end(), hit.index) == left.end()) left.push_back(hit.index);
    }
    origin = at.position;
    hit = geometry_->intersect_from(origin, hit, -at.face, direction);
  }
  Solids solids;
  for (auto instance = left.rbegin(); instance != left.rend(); ++instance) {
    const auto crossed =
        std::find_if(open.begin(), open.end(), [&](const Crossing& c) { return c.instance == *instance; });
    if (crossed->inwards < 0) solids.enter(*instance);
  }
  return solids;
}

}  // namespace pellucid
