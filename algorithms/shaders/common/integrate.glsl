// The medium along a path, back to front over equally spaced points (Imagire et al. 2007, Sec. 3.2, 3.3 and Fig. 7).
#include "algorithms/shaders/common/medium.glsl"
#include "algorithms/shaders/common/valid_path.glsl"

// `front`: local coordinates of the path's nearer end; `ray_local`: one metre along the viewing ray in local coordinates.
// Returns C and A of the path: what is behind becomes A × behind + C.
vec4 integrate_path(vec3 front, vec3 ray_local, float path_length, int samples, float sample_offset) {
  float count = float(samples);
  float step = path_length / count;  // Δd of this pixel, Eq. 2
  // Back to front over the points: C = A0·C0 + (1 − A0)·C, A = (1 − A0)·A.
#ifdef UNIFORM_SOURCE
  // With one C0 for all points, C = C0·(1 − A), and A = Π exp(−φ Δd) needs one exponential instead of N.
  float extinction = 0.0;
  for (int i = 0; i < samples; ++i) {
    extinction += medium_at(front + ray_local * sample_distance(path_length, float(i), count, sample_offset)).extinction;
  }
  float opacity = step_opacity(extinction, step);
  return vec4(opacity * medium_source(front, volume_albedo, vec4(1.0)), 1.0 - opacity);
#else
  vec3 color = vec3(0.0);
  float transmittance = 1.0;
#ifdef FILTER_OCCLUSION
  vec4 half_way = medium_visibility(front + ray_local * half_way_distance(path_length, 0.0, count, sample_offset));
#endif
  for (int i = 0; i < samples; ++i) {
    vec3 p = front + ray_local * sample_distance(path_length, float(i), count, sample_offset);
    vec4 visible = medium_visibility(p);
#ifdef FILTER_OCCLUSION
    vec4 next = medium_visibility(front + ray_local * half_way_distance(path_length, float(i) + 1.0, count, sample_offset));
    visible = filtered_occlusion(half_way, visible, next);
    half_way = next;
#endif
    MediumPoint medium = medium_at(p);
    float opacity = step_opacity(medium.extinction, step);
    color = mix(color, medium_source(p, medium.albedo, visible), opacity);
    transmittance *= 1.0 - opacity;
  }
  return vec4(color, transmittance);
#endif
}
