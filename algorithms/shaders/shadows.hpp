#pragma once

#include <algorithm>

/// Variance shadow maps (Donnelly and Lauritzen 2006, references.bib: donnelly2006), which Imagire et al. 2007 take
/// their occlusion rates from, and the anti-aliased rates of Imagire et al., Sec. 3.3. GLSL twin:
/// shaders/shadows.glsl.
namespace pellucid {

/// Chebyshev's bound: the share of a distribution with these moments that is not nearer than `depth` (their Eq. 5).
inline double chebyshev_bound(double mean, double mean_square, double depth, double min_variance) {
  if (depth <= mean) return 1;
  const double variance = std::max(mean_square - mean * mean, min_variance);
  const double behind = depth - mean;
  return variance / (variance + behind * behind);
}

/// Cuts off the lowest share of the bound, where light bleeds through overlapping occluders.
inline double reduce_bleeding(double bound, double amount) {
  return std::clamp((bound - amount) / (1 - amount), 0.0, 1.0);
}

/// Imagire et al. 2007, Eq. 4: the rate at a sampling point from its own and those at the two half-way points (Eq. 3).
inline double filtered_occlusion(double half_way_before, double at_point, double half_way_after) {
  return 0.25 * half_way_before + 0.5 * at_point + 0.25 * half_way_after;
}

}  // namespace pellucid
