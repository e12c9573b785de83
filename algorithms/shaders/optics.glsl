// Light at a smooth interface. C++ twin: algorithms/shaders/optics.hpp.

// Reflected share of unpolarised light at a dielectric; `eta`: the index before the interface over the index behind it.
// 1 beyond the critical angle.
float fresnel_dielectric(float cosine, float eta) {
  float sine2 = eta * eta * (1.0 - cosine * cosine);
  if (sine2 >= 1.0) return 1.0;
  float behind = sqrt(1.0 - sine2);
  float s = (eta * cosine - behind) / (eta * cosine + behind);
  float p = (cosine - eta * behind) / (cosine + eta * behind);
  return 0.5 * (s * s + p * p);
}

// Reflected share of a metal of index n + ik (Szirmay-Kalos et al. 2005, Sec. 3).
vec3 fresnel_metal(float cosine, vec3 n, vec3 k) {
  float g = 1.0 - cosine;  // may round below 0, where pow() has no value
  float grazing = g * g * g * g * g;
  vec3 k2 = k * k;
  return ((n - 1.0) * (n - 1.0) + k2 + 4.0 * n * grazing) / ((n + 1.0) * (n + 1.0) + k2);
}

// The light that absorption leaves over a path [m] (Beer-Lambert).
vec3 transmitted(vec3 absorption, float path) { return exp(-absorption * path); }
