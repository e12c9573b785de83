#pragma once

#include <functional>

#include <glm/glm.hpp>

#include "algorithms/reference/relief/height_field.hpp"
#include "algorithms/scene/relief/relief.hpp"

namespace pellucid {

/// A ray in air of varying index: it comes to the mesh, leaves the air upwards, or was stopped on its way.
struct BentRay {
  enum class End { comes_down, leaves, stopped };
  End end = End::leaves;
  glm::dvec3 position{0.0}, direction{0.0};  ///< at its end, unless it was stopped; frame; direction unit
};

/// Follows `ray`, which begins in the air, by Runge and Kutta's rule of fourth order over the path parameter σ,
/// dσ = ds / n, where d²p/dσ² = ∇(n²)/2 (references.bib: timonen, Sec. 6). `step_m`: length of a step. `stops` is asked
/// of chords of a few steps, one after the other, in the frame: true ends the ray.
BentRay bend_through(const ReliefAir&, const ReliefRay& ray, double step_m,
                     const std::function<bool(const glm::dvec3& from, const glm::dvec3& to)>& stops = {});

}  // namespace pellucid
