#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/reference/geometry.hpp"
#include "algorithms/reference/interface_bend.hpp"
#include "algorithms/reference/surface_point.hpp"
#include "algorithms/scene/scene.hpp"

/// The tree of rays that one ray becomes at mirrors, metals and dielectrics: the same for light that is looked for
/// (from the eye) and for light that is sent (from a lamp).
namespace pellucid {

/// The dielectric solids that a ray is inside of, outermost first.
class Solids {
 public:
  bool empty() const { return count_ == 0; }
  int innermost() const { return of_[count_ - 1]; }
  void enter(int instance);  ///< RuntimeError when they nest deeper than can be held
  void leave(int instance);  ///< no matter if it was not entered: the mesh is open then
  bool contains(int instance) const;

 private:
  std::array<int, 8> of_{};
  std::size_t count_ = 0;
};

/// Where the tree ends, other than in light.
struct TreeLimits {
  int reflections = 0;  ///< inside solids, since the outermost was entered
  int depth = 0;        ///< interfaces from the root on
  double cut = 0.0;     ///< a branch of less weight in every channel is cut
  bool entry_reflection = true;
  bool both_sides = true;
  /// Decides about a branch of weight w below `cut`: gives the factor to go on with (1/p), or 0. None: always 0.
  std::function<double(double share)> roulette;
};

/// The cost of a tree, and the light that it left out. Weights are of the worst channel, the root's being 1.
struct TreeTally {
  double cut_weight = 0.0;      ///< of branches below `cut` or beyond `depth`
  double limited_weight = 0.0;  ///< of those that `reflections`, `entry_reflection` leave out by definition
  double lost_weight = 0.0;     ///< of rays that left a solid unmet, or that they had not entered: the mesh is open
  std::uint64_t rays = 0;

  void add(const TreeTally& other) {
    cut_weight += other.cut_weight;
    limited_weight += other.limited_weight;
    lost_weight += other.lost_weight;
    rays += other.rays;
  }
};

struct TreeRay {
  glm::dvec3 origin{0.0}, direction{0.0};
  double begin = 0.0, end = std::numeric_limits<double>::infinity();  ///< of the root's own segment
  Solids inside;
  double unabsorbed_m = 0.0;  ///< from the origin, where `inside` does not hold yet
  int only_first = -1;        ///< an instance: nothing is followed or called if the ray meets anything else before it
};

class RayTree {
 public:
  /// Keeps the addresses of both.
  RayTree(const Scene& scene, const Geometry& geometry) : scene_(&scene), geometry_(&geometry) {}

  /// A branch that waits, and the stack of them: kept between trees, since it spares allocations.
  struct Branch {
    Hit from;  // instance null: the root
    glm::dvec3 start{0.0}, face{0.0}, direction{0.0}, weight{1.0};
    Solids inside;
    int depth = 0, reflections = 0;
  };
  using Scratch = std::vector<Branch>;

  /// Calls diffuse(hit, point, direction, weight) where a branch ends at a Lambertian surface and
  /// miss(direction, weight) where it leaves the scene. Returns the first hit of the root.
  /// relief(hit, point, direction, weight) where one meets a mesh that carries a relief: true if it ends there, else it
  /// goes on behind the mesh.
  template <class Diffuse, class Miss, class Relief>
  Hit trace(const TreeRay& root, const TreeLimits& limits, Scratch& scratch, TreeTally& tally, Diffuse diffuse,
            Miss miss, Relief relief) const;
  /// The same; branches end at reliefs.
  template <class Diffuse, class Miss>
  Hit trace(const TreeRay& root, const TreeLimits& limits, Scratch& scratch, TreeTally& tally, Diffuse diffuse,
            Miss miss) const {
    return trace(root, limits, scratch, tally, diffuse, miss,
                 [](const Hit&, const SurfacePoint&, const glm::dvec3&, const glm::dvec3&) { return true; });
  }

  /// The dielectrics that a point lies in, by the surfaces that a ray from it crosses.
  Solids solids_at(const glm::dvec3& point) const;

 private:
  void branch(const Branch& parent, const Hit& hit, const SurfacePoint& point, const TreeLimits& limits,
              Scratch& scratch, TreeTally& tally) const;
  void push(Branch child, const glm::dvec3& weight, const TreeLimits& limits, Scratch& scratch, TreeTally& tally) const;
  void pass(const Branch& parent, const Hit& hit, const SurfacePoint& point, Scratch& scratch) const;
  glm::dvec3 absorbed(const Branch& branch, double path_m) const;

  const Scene* scene_;
  const Geometry* geometry_;
};

inline double worst(const glm::dvec3& weight) {
  return glm::max(weight.x, glm::max(weight.y, weight.z));
}

template <class Diffuse, class Miss, class Relief>
Hit RayTree::trace(const TreeRay& root, const TreeLimits& limits, Scratch& scratch, TreeTally& tally, Diffuse diffuse,
                   Miss miss, Relief relief) const {
  scratch.clear();
  Branch current;
  current.start = root.origin;
  current.direction = root.direction;
  current.inside = root.inside;
  Hit first;
  for (bool at_root = true;; at_root = false) {
    ++tally.rays;
    const Hit hit = at_root ? geometry_->intersect(current.start, current.direction, root.begin, root.end)
                            : geometry_->intersect_from(current.start, current.from, current.face, current.direction);
    if (at_root) {
      first = hit;
      if (root.only_first >= 0 && hit.index != root.only_first) return first;
    }
    if (!current.inside.empty())
      current.weight *= absorbed(current, hit.distance - (at_root ? root.unabsorbed_m : 0.0));
    if (hit.instance == nullptr) {
      if (!current.inside.empty()) tally.lost_weight += worst(current.weight);
      miss(current.direction, current.weight);
    } else {
      const SurfacePoint point = surface_at(*scene_, *geometry_, hit, current.start, current.direction);
      if (hit.instance->relief >= 0) {
        if (!relief(hit, point, current.direction, current.weight)) pass(current, hit, point, scratch);
      } else if (optical(*scene_, *hit.instance)) {
        branch(current, hit, point, limits, scratch, tally);
      } else {
        diffuse(hit, point, current.direction, current.weight);
      }
    }
    if (scratch.empty()) return first;
    current = scratch.back();
    scratch.pop_back();
  }
}

}  // namespace pellucid
