// Light on its way to a point between or on the layers (Timonen, Sec. 3.1, Algorithm 2). C++ twin, by exact hits:
// algorithms/reference/relief/relief_tracer.cpp.
#include "algorithms/shaders/optics.glsl"
#include "algorithms/translucent_relief/layers.glsl"
#ifdef SCATTERING
#include "algorithms/translucent_relief/scattering.glsl"
#endif

vec4 taken = vec4(0.0);  // heights asked for, by kind of ray

int steps_of(int kind, Ray ray) {
  float share = mix(1.0, steps_at_normal, abs(ray.direction.z));
  return max(1, int(ceil(share * step_counts[kind])));
}

float find_crossing(int layer, Ray ray, float from, float side, int kind) {
  float count = 0.0;
  float t;
  vec2 range = clip_to_layer(layer, ray, from);
  RECORDED(heights = 0u;)
#if SEARCH == 1
  t = max_mip_crossing(layer, ray, tiling, range, side, 16 * int(step_counts[kind]), count);
#else
  int steps = steps_of(kind, ray), halvings = int(refinements[kind]);
  vec2 bounds = bounds_of(layer);
  float bias = 1e-5 * (bounds.y - bounds.x);
#if SEARCH >= 2
  if (side > 0.0 && layer != kEither)
    t = cone_crossing(layer, ray, tiling, range_of(layer), range, bias, steps, halvings, count);
  else
#endif
    t = linear_crossing(layer, ray, tiling, range, side, bias, steps, halvings, count);
#endif
  taken[kind] += count;
  RECORDED(if (layer == kEither) heights /= 2u;)
  RECORDED(record_search(t >= 0.0, tiling * uv_at(ray, range.x), tiling * uv_at(ray, t < 0.0 ? range.y : t));)
  return t;
}

// Share of the light from `to_light` that reaches `p`, which lies on `side` of the medium's surface: 0 behind the solid,
// else the refracted shares of all boundaries on the way, and what absorption leaves. Rays go straight, as in the paper.
vec3 light_reaching(Ray frame, vec3 p, vec3 to_light, float side) {
  if (to_light.z <= 0.0) return vec3(0.0);
  Ray ray = Ray(p, to_light, frame.uv, frame.uv_per_metre);
#ifdef OCCLUSION
  if (find_crossing(kSolid, ray, 0.0, 1.0, kLight) >= 0.0) return vec3(0.0);
#ifdef TWO_LAYERS
  float share = 1.0, inside = 0.0, from = 0.0;
  int i = 0;
  bool met;
  do {
    float t = find_crossing(kMedium, ray, from, side, kLight);
    met = t >= 0.0;
    if (met) {
      float cosine = abs(dot(to_light, medium_normal(tiling * uv_at(ray, t), ray.uv_per_metre)));
      share *= 1.0 - fresnel_dielectric(cosine, side < 0.0 ? index_ratios.x : index_ratios.y);
      if (side < 0.0) inside += t - from;
      from = t;
      side = -side;
    }
  } while (met && ++i < boundaries);
  if (side < 0.0) inside += max(clip_to_layer(kEither, ray, from).y - from, 0.0);
#ifdef ABSORPTION
#ifdef SCATTERING
  return share * scattered_transmittance(inside);
#else
  return share * transmitted(absorption, inside);
#endif
#endif
  return vec3(share);
#endif
#endif
  return vec3(1.0);
}
