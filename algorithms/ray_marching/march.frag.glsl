// The whole volume in one pass: N points between the box's entry and its exit or the opaque object before it.
#include "algorithms/shaders/medium.glsl"
#include "algorithms/shaders/integrate.glsl"

layout(binding = 1) uniform sampler2D eye_distance_map;
uniform vec3 view_axis;  // unit, into the screen
uniform float near_m;
flat in int sample_count;
flat in float sample_offset;

layout(location = 0) out vec4 color_and_transmittance;

#ifdef JITTER_TILE
// Each pixel of a tile has a place of its own: its rank in the tile, spread by a permutation in which neighbours lie far
// apart, so that the pattern is fine-grained (Keller and Heidrich 2001, Sec. 3).
float interleaved_offset(ivec2 pixel) {
  ivec2 p = pixel % JITTER_TILE;
  const int count = JITTER_TILE * JITTER_TILE;
  int rank = p.x + JITTER_TILE * p.y;
  return (float((rank * JITTER_STRIDE) % count) + 0.5) / float(count);
}
#endif

void main() {
  // The fragment lies on the box's back faces, so that each pixel has one.
  float per_m = inversesqrt(dot(from_eye, from_eye));
  vec3 eye_local = local - local_from_eye;
  vec3 ray_local = local_from_eye * per_m;
  vec3 t0 = -eye_local / ray_local, t1 = (1.0 - eye_local) / ray_local;
  vec3 entry = min(t0, t1), leave = max(t0, t1);
  float begin = max(max(max(entry.x, entry.y), entry.z), near_m / (dot(from_eye, view_axis) * per_m));
  float end = min(min(min(leave.x, leave.y), leave.z), texelFetch(eye_distance_map, ivec2(gl_FragCoord.xy), 0).r);
#ifdef JITTER_TILE
  float offset = interleaved_offset(ivec2(gl_FragCoord.xy));
#else
  float offset = sample_offset;
#endif
  MediumPath path = medium_path(eye_local + begin * ray_local, begin);
  color_and_transmittance = integrate_path(path, max(end - begin, 0.0), sample_count, offset);
}
