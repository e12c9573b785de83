// The whole volume in one pass: N points between the box's entry and its exit or the opaque object before it.
#include "algorithms/shaders/common/integrate.glsl"

in vec3 local;  // on the box's back faces, each pixel once

layout(binding = 1) uniform sampler2D eye_distance_map;
uniform mat4 world_to_local;
uniform vec3 eye;
uniform vec3 view_axis;  // unit, into the screen
uniform float near_m;
uniform int samples;
uniform float sample_offset;

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
  vec3 ray = normalize(medium_world(local) - eye);
  vec3 origin_local = (world_to_local * vec4(eye, 1.0)).xyz;
  vec3 ray_local = mat3(world_to_local) * ray;
  vec3 t0 = -origin_local / ray_local, t1 = (1.0 - origin_local) / ray_local;
  vec3 entry = min(t0, t1), leave = max(t0, t1);
  float begin = max(max(max(entry.x, entry.y), entry.z), near_m / dot(ray, view_axis));
  float end = min(min(min(leave.x, leave.y), leave.z), texelFetch(eye_distance_map, ivec2(gl_FragCoord.xy), 0).r);
#ifdef JITTER_TILE
  float offset = interleaved_offset(ivec2(gl_FragCoord.xy));
#else
  float offset = sample_offset;
#endif
  color_and_transmittance = integrate_path(origin_local + begin * ray_local, ray_local, max(end - begin, 0.0), samples, offset);
}
