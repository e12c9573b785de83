// The medium along a path, back to front over equally spaced points (Imagire et al. 2007, Sec. 3.2, 3.3 and Fig. 7). The
// includer has medium.glsl's MediumPath and what asks it.
#include "algorithms/shaders/occlusion.glsl"
#include "algorithms/shaders/opacity.glsl"
#include "algorithms/shaders/valid_path.glsl"

#ifndef UNIFORM_SOURCE
struct PathSum {
  vec3 color;  // C
  float transmittance;  // A
  vec4 half_way;  // light that reaches the half-way point behind the next
};

// The i-th of `count` points, back to front: C = A0·C0 + (1 − A0)·C, A = (1 − A0)·A.
void add_point(inout PathSum sum, MediumPath path, float path_length, float i, float count, float sample_offset) {
  float t = sample_distance(path_length, i, count, sample_offset);
  vec4 visible = medium_visibility(path, t);
#ifdef FILTER_OCCLUSION
  vec4 next = medium_visibility(path, half_way_distance(path_length, i + 1.0, count, sample_offset));
  visible = filtered_occlusion(sum.half_way, visible, next);
  sum.half_way = next;
#endif
  MediumPoint medium = medium_at(medium_place(path, t));
  float opacity = step_opacity(medium.extinction, path_length / count);  // over Δd of this pixel, Eq. 2
  sum.color = mix(sum.color, medium_source(path, t, medium.albedo, visible), opacity);
  sum.transmittance *= 1.0 - opacity;
}
#endif

// Returns C and A of the path: what is behind becomes A × behind + C.
vec4 integrate_path(MediumPath path, float path_length, int samples, float sample_offset) {
  float count = float(samples);
#ifdef UNIFORM_SOURCE
  // With one C0 for all points, C = C0·(1 − A), and A = Π exp(−φ Δd) needs one exponential instead of N.
  float extinction = 0.0;
  for (int i = 0; i < samples; ++i) {
    extinction += medium_at(medium_place(path, sample_distance(path_length, float(i), count, sample_offset))).extinction;
  }
  float opacity = step_opacity(extinction, path_length / count);
  return vec4(opacity * medium_source(path, 0.0, vec3(1.0), vec4(1.0)), 1.0 - opacity);
#else
  PathSum sum = PathSum(vec3(0.0), 1.0, vec4(1.0));
#ifdef FILTER_OCCLUSION
  sum.half_way = medium_visibility(path, half_way_distance(path_length, 0.0, count, sample_offset));
#endif
#ifdef EACH_SAMPLE
  // "SAMPLE(0) SAMPLE(1) …" instead of the loop where they are few: a software rasteriser masks all that a loop carries.
#define SAMPLE(i) add_point(sum, path, path_length, float(i), count, sample_offset);
  EACH_SAMPLE
#else
  for (int i = 0; i < samples; ++i) add_point(sum, path, path_length, float(i), count, sample_offset);
#endif
  return vec4(sum.color, sum.transmittance);
#endif
}
