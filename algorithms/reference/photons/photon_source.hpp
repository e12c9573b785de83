#pragma once

#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/reference/shading.hpp"
#include "algorithms/scene/scene.hpp"

namespace pellucid {

struct Sphere {
  glm::dvec3 center{0.0};
  double radius = 0.0;
};

/// About an instance's bounding box in the world.
Sphere bounding_sphere(const Scene&, int instance);

/// The photons that one light sends towards one object.
class PhotonSource {
 public:
  /// `scene_size`: nothing lies farther from `object`'s centre.
  PhotonSource(const Illumination::Emitter&, const Sphere& object, double scene_size);

  struct Photon {
    glm::dvec3 origin{0.0}, direction{0.0};
    glm::dvec3 power{0.0};  ///< [W] if it stood for all; 0 outside a spot
  };
  /// From a point of the unit square, area-preserving: evenly over the disc or cone that holds the object.
  Photon at(const glm::dvec2& place) const;

 private:
  Illumination::Emitter light_;
  Sphere object_;
  glm::dvec3 axis_{0.0}, right_{0.0}, up_{0.0};
  double start_m_ = 0.0;  // directional: the disc lies this far before the centre
  double cap_ = 2.0;      // others: 1 − cos of the half-angle that holds the object
};

}  // namespace pellucid
