// Occlusion rates. C++ twin: algorithms/shaders/shadows.hpp.

// Chebyshev's bound over the moments of the occluders' depth (Donnelly and Lauritzen 2006, Eq. 5).
float chebyshev_bound(vec2 moments, float depth, float min_variance) {
  float variance = max(moments.y - moments.x * moments.x, min_variance);
  float behind = depth - moments.x;
  return behind <= 0.0 ? 1.0 : variance / (variance + behind * behind);
}

// `cut`: the lowest share of the bound, which counts as shadow, and one over what is left of it. A bound is at most 1, and
// so is the result.
float reduce_bleeding(float bound, vec2 cut) { return max((bound - cut.x) * cut.y, 0.0); }

// Imagire et al. 2007, Eq. 4.
vec4 filtered_occlusion(vec4 half_way_before, vec4 at_point, vec4 half_way_after) {
  return 0.5 * at_point + 0.25 * (half_way_before + half_way_after);
}
