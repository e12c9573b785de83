#pragma once

#include <glm/glm.hpp>

#include "algorithms/scene/scene.hpp"

namespace pellucid {

/// An axis-aligned box [m].
struct Bounds {
  glm::vec3 min{0.0F};
  glm::vec3 max{0.0F};
  glm::vec3 corner(int i) const {  ///< 0 to 7; bits 0, 1, 2: at the far end of x, y, z
    return {(i & 1) != 0 ? max.x : min.x, (i & 2) != 0 ? max.y : min.y, (i & 4) != 0 ? max.z : min.z};
  }
};

/// In its own coordinates; a point at the origin when it has no vertices.
Bounds mesh_bounds(const Mesh&);

/// The bounds of every instance and the volume, in the world; a point at the origin when the scene has neither.
Bounds world_bounds(const Scene&);

}  // namespace pellucid
