#pragma once

#include <glm/glm.hpp>

#include "algorithms/reference/relief/height_field.hpp"
#include "algorithms/scene/relief/relief.hpp"

namespace pellucid {

/// A ray in air of varying index: where it comes to the mesh, or leaves the air upwards.
struct BentRay {
  bool meets = false;
  glm::dvec3 position{0.0}, direction{0.0};  ///< frame; direction unit
};

/// Follows `ray`, which begins in the air, by Runge and Kutta's rule of fourth order over the path parameter σ,
/// dσ = ds / n, where d²p/dσ² = ∇(n²)/2 (references.bib: timonen, Sec. 6). `step_m`: length of a step.
BentRay bend_through(const ReliefAir&, const ReliefRay& ray, double step_m);

}  // namespace pellucid
