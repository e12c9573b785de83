// Runs the shader functions that have C++ twins on the inputs of the test.
#include "algorithms/shaders/opacity.glsl"
#include "algorithms/shaders/valid_path.glsl"

layout(local_size_x = 64) in;

struct Input {
  vec4 extinction_interval_step_offset;
  vec4 s_count;
  vec4 sf_i;
  vec4 ray_opacity;
};
struct Output {
  float voxel, corrected, step, path, sample_at, half_way_behind, half_way_before, pad;
};
layout(std430, binding = 0) readonly buffer Inputs { Input inputs[]; };
layout(std430, binding = 1) writeonly buffer Outputs { Output outputs[]; };

void main() {
  uint k = gl_GlobalInvocationID.x;
  if (k >= inputs.length()) return;
  Input q = inputs[k];
  vec4 e = q.extinction_interval_step_offset;
  float path = valid_path_length(q.s_count.xyz, q.sf_i.xyz, q.ray_opacity.xyz);
  outputs[k] = Output(voxel_opacity(e.x, e.y), corrected_opacity(q.ray_opacity.w, e.z / e.y), step_opacity(e.x, e.z), path,
                      sample_distance(path, q.sf_i.w, q.s_count.w, e.w), half_way_distance(path, q.sf_i.w, q.s_count.w, e.w),
                      half_way_distance(path, q.sf_i.w + 1.0, q.s_count.w, e.w), 0.0);
}
