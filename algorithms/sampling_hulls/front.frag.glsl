// Front faces of a hull into the back buffer: N points on the valid path, blended once (Sec. 3.2 and Fig. 7).
#include "algorithms/shaders/common/medium.glsl"
#include "algorithms/sampling_hulls/valid_path.glsl"

in vec3 local;

layout(binding = 1) uniform sampler2D coordinates_map;
uniform mat4 world_to_local;
uniform vec3 eye;
uniform float sample_offset;

layout(location = 0) out vec4 color_and_transmittance;

void main() {
  // s(R) from the local-coordinates map: the hull's back face or an opaque object, whichever is nearer; s^F(R) here.
  vec3 s = texelFetch(coordinates_map, ivec2(gl_FragCoord.xy), 0).xyz;
  vec3 s_world = (volume_to_world * vec4(s, 1.0)).xyz;
  vec3 sf_world = (volume_to_world * vec4(local, 1.0)).xyz;
  vec3 ray = normalize(sf_world - eye);
  float path_length = valid_path_length(s_world, sf_world, ray);
  vec3 ray_local = mat3(world_to_local) * ray;
  float step = path_length / float(SAMPLES);  // Δd of this pixel and hull, Eq. 2

  // Back to front over the points: C = A0·C0 + (1 − A0)·C, A = (1 − A0)·A.
#ifdef UNIFORM_SOURCE
  // With one C0 for all points, C = C0·(1 − A), and A = Π exp(−φ Δd) needs one exponential instead of N.
  float extinction = 0.0;
  for (int i = 0; i < SAMPLES; ++i) {
    extinction += medium_extinction(local + ray_local * sample_distance(path_length, float(i), float(SAMPLES), sample_offset));
  }
  float opacity = step_opacity(extinction, step);
  color_and_transmittance = vec4(opacity * medium_source(local), 1.0 - opacity);
#else
  vec3 color = vec3(0.0);
  float transmittance = 1.0;
  for (int i = 0; i < SAMPLES; ++i) {
    vec3 p = local + ray_local * sample_distance(path_length, float(i), float(SAMPLES), sample_offset);
    float opacity = step_opacity(medium_extinction(p), step);
    color = mix(color, medium_source(p), opacity);
    transmittance *= 1.0 - opacity;
  }
  color_and_transmittance = vec4(color, transmittance);
#endif
}
