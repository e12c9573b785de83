#pragma once

#include <cmath>

/// Opacity of a step through a medium (Imagire et al. 2007, Appendix A.1). GLSL twin: shaders/opacity.glsl.
namespace pellucid {

/// Eq. 5: opacity over the voxel interval Δd0 [m] at extinction φ [1/m].
inline double voxel_opacity(double extinction, double interval_m) {
  return -std::expm1(-extinction * interval_m);
}

/// Eq. 6: `opacity` of the voxel interval Δd0, corrected to a step of another length; `steps` = Δd / Δd0 ≥ 0.
inline double corrected_opacity(double opacity, double steps) {
  if (steps <= 0) return 0;
  return opacity >= 1 ? 1 : 1 - std::pow(1 - opacity, steps);
}

/// Eq. 6 of Eq. 5, where Δd0 cancels.
inline double step_opacity(double extinction, double step_m) {
  return -std::expm1(-extinction * step_m);
}

}  // namespace pellucid
