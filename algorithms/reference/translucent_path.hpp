#pragma once

#include <algorithm>
#include <limits>

#include "algorithms/reference/ray_tree.hpp"
#include "algorithms/scene/noise.hpp"

/// Light in solids whose medium scatters, by unbiased random walks inside the exact meshes. A refracting interface
/// leaves no way to connect a point inside with a light outside, so a walk ends where it leaves: in the environment, or
/// at a Lambertian surface. Media are homogeneous and scatter by
/// Henyey and Greenstein's phase function; a path's distances are all drawn for one channel, and weighed by how likely
/// they are for all three, so that no weight grows without bound.
namespace pellucid {

/// True if a material that some instance has scatters.
bool has_scattering(const Scene&);

class TranslucentPath {
 public:
  /// Keeps the addresses.
  TranslucentPath(const Scene& scene, const Geometry& geometry) : scene_(&scene), geometry_(&geometry) {}

  /// Follows one path, and where the first surface is an interface both of its branches. `limits.reflections` counts
  /// internal reflections of light that is not yet scattered; `cut` is not used, since weak paths are ended by chance
  /// and the others weigh more for it. Calls as RayTree::trace does, and returns the first hit.
  template <class Diffuse, class Miss>
  Hit trace(const TreeRay& root, const TreeLimits& limits, Random& random, TreeTally& tally, Diffuse diffuse,
            Miss miss) const;

 private:
  struct Walker {
    Hit from;  // instance null: it sets out in free space
    glm::dvec3 start{0.0}, face{0.0}, direction{0.0};
    glm::dvec3 weight{1.0};  // of the interfaces, and of chance
    // The media transmit this of each channel over the distances gone, and these are their likelihoods; times one
    // factor.
    glm::dvec3 left{1.0}, likelihood{1.0};
    Solids inside;
    int events = 0, reflections = 0, channel = 0;
    glm::dvec3 light() const { return weight * left * (3.0 / (likelihood.x + likelihood.y + likelihood.z)); }
    bool scattered = false, ended = false;
  };
  static constexpr int kMostEvents = 100'000;  // of one path; more is the work of an open mesh

  const Material* medium(const Walker&) const;
  bool scatter(Walker&, const Material&, double distance, Random&) const;
  void interact(Walker&, const Hit&, const SurfacePoint&, const TreeLimits&, Random&, TreeTally&, Walker* other) const;
  static void reflect_off(Walker&, const SurfacePoint&, const TreeLimits&, const glm::dvec3& direction, TreeTally&);
  static void roulette(Walker&, Random&);

  const Scene* scene_;
  const Geometry* geometry_;
};

template <class Diffuse, class Miss>
Hit TranslucentPath::trace(const TreeRay& root, const TreeLimits& limits, Random& random, TreeTally& tally,
                           Diffuse diffuse, Miss miss) const {
  Walker walkers[2];  // the second waits for the first to end
  walkers[0].start = root.origin;
  walkers[0].direction = root.direction;
  walkers[0].inside = root.inside;
  walkers[0].channel = std::min(2, static_cast<int>(3.0F * random.next()));
  walkers[1].ended = true;
  Hit first;
  bool at_root = true;
  for (Walker& walker : walkers) {
    while (!walker.ended) {
      ++tally.rays;
      const double begin = at_root ? root.begin : 0.0;
      const Hit hit = walker.from.instance != nullptr
                          ? geometry_->intersect_from(walker.start, walker.from, walker.face, walker.direction)
                          : geometry_->intersect(walker.start, walker.direction, begin,
                                                 at_root ? root.end : std::numeric_limits<double>::infinity());
      if (at_root) first = hit;
      const double unabsorbed = at_root ? root.unabsorbed_m : 0.0;
      Walker* other = at_root ? &walkers[1] : nullptr;
      at_root = false;
      if (hit.instance == nullptr && !walker.inside.empty()) {
        // Out of a solid without having met it: through a hole, or past a sharp edge by rounding. No medium is there.
        tally.lost_weight += worst(walker.light());
        walker.inside = {};
      }
      if (const Material* inside = medium(walker)) {
        if (unabsorbed > 0.0) walker.start += unabsorbed * walker.direction;
        if (scatter(walker, *inside, hit.distance - unabsorbed, random)) continue;
      }
      if (hit.instance == nullptr) {
        miss(walker.direction, walker.light());
        break;
      }
      const SurfacePoint point = surface_at(*scene_, *geometry_, hit, walker.start, walker.direction);
      if (!optical(*scene_, *hit.instance)) {
        diffuse(hit, point, walker.direction, walker.light());
        break;
      }
      interact(walker, hit, point, limits, random, tally, other);
    }
  }
  return first;
}

}  // namespace pellucid
