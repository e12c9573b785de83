#pragma once

#include <glm/glm.hpp>

#include "algorithms/scene/scene.hpp"

namespace pellucid {

/// An axis-aligned box in the world [m].
struct Bounds {
  glm::vec3 min{0.0F};
  glm::vec3 max{0.0F};
};

/// Of every instance and the volume; a point at the origin when the scene has neither.
Bounds world_bounds(const Scene&);

}  // namespace pellucid
