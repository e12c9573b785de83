// Runs the occlusion functions that have C++ twins on the inputs of the test.
#include "algorithms/shaders/occlusion.glsl"

layout(local_size_x = 64) in;

struct Input {
  vec4 moments_depth_variance;
  vec4 amount_rates;
};
layout(std430, binding = 0) readonly buffer Inputs { Input inputs[]; };
layout(std430, binding = 1) writeonly buffer Outputs { vec4 outputs[]; };

void main() {
  uint k = gl_GlobalInvocationID.x;
  if (k >= inputs.length()) return;
  vec4 m = inputs[k].moments_depth_variance, r = inputs[k].amount_rates;
  float bound = chebyshev_bound(m.xy, m.z, m.w);
  outputs[k] = vec4(bound, reduce_bleeding(r.w, vec2(r.x, 1.0 / (1.0 - r.x))), filtered_occlusion(vec4(r.y), vec4(r.z), vec4(r.w)).x, 0.0);
}
