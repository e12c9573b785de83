// The loop of integrate.glsl over a medium, a source and shadows that the test knows: its calls of medium.glsl are turned
// to these.
#include "algorithms/shaders/common/medium.glsl"
#include "algorithms/shaders/common/valid_path.glsl"

layout(local_size_x = 64) in;

struct Path {
  vec4 length_samples_offset_extinction;
  vec4 shadow_edges;  // along the path, one for each light: lit up to there, dark behind, or the reverse where negative
};
layout(std430, binding = 0) readonly buffer Paths { Path paths[]; };
layout(std430, binding = 1) writeonly buffer Outputs { vec4 outputs[]; };

Path path;

vec4 known_visibility(vec3 p) {
  vec4 at = vec4(p.x);
  return mix(step(at, path.shadow_edges), step(-path.shadow_edges, at), lessThan(path.shadow_edges, vec4(0.0)));
}
MediumPoint known_medium(vec3 p) { return MediumPoint(path.length_samples_offset_extinction.w * (1.0 + p.x), vec3(1.0)); }
vec3 known_source(vec3 p, vec3 albedo, vec4 visible) { return albedo * visible.xyz + vec3(visible.w, 0.0, 0.0); }

#define medium_visibility known_visibility
#define medium_at known_medium
#define medium_source known_source
#define FILTER_OCCLUSION
#include "algorithms/shaders/common/integrate.glsl"

void main() {
  uint k = gl_GlobalInvocationID.x;
  if (k >= paths.length()) return;
  path = paths[k];
  vec4 q = path.length_samples_offset_extinction;
  outputs[k] = integrate_path(vec3(0.0), vec3(1.0, 0.0, 0.0), q.x, int(q.y), q.z);
}
