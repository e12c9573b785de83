// The loop of integrate.glsl over a medium, a source and shadows that the test knows, in medium.glsl's place.
layout(local_size_x = 64) in;

struct Path {
  vec4 length_samples_offset_extinction;
  vec4 shadow_edges;  // along the path, one for each light: lit up to there, dark behind, or the reverse where negative
};
layout(std430, binding = 0) readonly buffer Paths { Path paths[]; };
layout(std430, binding = 1) writeonly buffer Outputs { vec4 outputs[]; };

Path path;

struct MediumPoint {
  float extinction;
  vec3 albedo;
};
struct MediumPath {
  vec3 front, front_per_m;
};

vec3 medium_place(MediumPath along, float t) { return along.front + t * along.front_per_m; }
vec4 medium_visibility(MediumPath along, float t) {
  vec4 at = vec4(t);
  return mix(step(at, path.shadow_edges), step(-path.shadow_edges, at), lessThan(path.shadow_edges, vec4(0.0)));
}
MediumPoint medium_at(vec3 p) { return MediumPoint(path.length_samples_offset_extinction.w * (1.0 + p.x), vec3(1.0)); }
vec3 medium_source(MediumPath along, float t, vec3 albedo, vec4 visible) { return albedo * visible.xyz + vec3(visible.w, 0.0, 0.0); }

#define FILTER_OCCLUSION
#include "algorithms/shaders/integrate.glsl"

void main() {
  uint k = gl_GlobalInvocationID.x;
  if (k >= paths.length()) return;
  path = paths[k];
  vec4 q = path.length_samples_offset_extinction;
  outputs[k] = integrate_path(MediumPath(vec3(0.0), vec3(1.0, 0.0, 0.0)), q.x, int(q.y), q.z);
}
