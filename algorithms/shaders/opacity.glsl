// Opacity of a step through a medium (Imagire et al. 2007, Appendix A.1). C++ twin: algorithms/shaders/opacity.hpp.

// Eq. 5: opacity over the voxel interval Δd0 at extinction φ.
float voxel_opacity(float extinction, float interval) { return 1.0 - exp(-extinction * interval); }

// Eq. 6: opacity α of the interval Δd0, corrected to a step of another length; `steps` = Δd / Δd0. An opaque voxel stays
// opaque over any step but one of no length.
float corrected_opacity(float opacity, float steps) {
  if (steps <= 0.0) return 0.0;
  return opacity >= 1.0 ? 1.0 : 1.0 - pow(1.0 - opacity, steps);
}

// Eq. 6 of Eq. 5, where Δd0 cancels: what the techniques evaluate at each point, since φ itself is at hand.
float step_opacity(float extinction, float step) { return 1.0 - exp(-extinction * step); }
