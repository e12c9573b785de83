#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/reference/interval.hpp"
#include "algorithms/reference/ray_shadows.hpp"
#include "algorithms/reference/shading.hpp"
#include "algorithms/scene/scene.hpp"

/// Which lights reach the medium where along a ray.
namespace pellucid {

/// The part of a ray up to `end_m`, from where the one before ends.
struct LitPart {
  double end_m = 0;
  unsigned lights = 0;  ///< bit i: the light i reaches it
};

/// Cuts rays where a light's share of the source radiance is not smooth: at the edges of shadows and of a spot's two
/// cones; and ever finer towards the point nearest to a light, so that its 1/r² is smooth on each part.
class LightPath {
 public:
  /// `light` has the scene's lights. For a volume in a light's space only that light counts. Keeps no reference to the
  /// scene, but the address of `light`.
  LightPath(const Scene&, const Volume&, const Illumination& light);

  /// True if no light is ever cut: neither shadow, nor cone, nor distance.
  bool plain() const;

  struct Scratch {
    std::vector<Interval> in_cone, shadows;
    std::vector<std::vector<Interval>> lit;  // of each light, rising and apart
    std::vector<double> cuts;
  };
  /// Replaces `parts` by the parts of origin + t·direction, t in `inside`, front to back; `direction` unit.
  void find(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside, Scratch& scratch,
            std::vector<LitPart>& parts) const;

 private:
  struct Ray {
    glm::dvec3 origin, direction;
  };
  using Emitter = Illumination::Emitter;
  void cut_cone(const Emitter& light, double cosine, const Ray& ray, const Interval& part,
                std::vector<double>& cuts) const;
  void find_in_cone(const Emitter& light, const Ray& ray, const Interval& inside, std::vector<Interval>& parts) const;
  void find_lit(std::size_t index, const Ray& ray, const Interval& inside, Scratch& scratch) const;
  void grade(const Emitter& light, const Ray& ray, const Interval& part, std::vector<double>& cuts) const;

  const Illumination* light_;
  std::optional<std::size_t> only_;  // the light in whose space the volume lies
  std::optional<RayShadows> shadows_;
};

}  // namespace pellucid
