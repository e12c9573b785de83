// Runs the laws of optics on the inputs of the test.
#include "algorithms/shaders/optics.glsl"

layout(local_size_x = 64) in;

struct Input {
  vec4 n_cosine;
  vec4 k_eta;
  vec4 absorption_path;
};
struct Output {
  vec4 metal_dielectric;
  vec4 transmitted;
};
layout(std430, binding = 0) readonly buffer Inputs { Input inputs[]; };
layout(std430, binding = 1) writeonly buffer Outputs { Output outputs[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= inputs.length()) return;
  Input q = inputs[i];
  outputs[i] = Output(vec4(fresnel_metal(q.n_cosine.w, q.n_cosine.xyz, q.k_eta.xyz),
                           fresnel_dielectric(q.n_cosine.w, q.k_eta.w)),
                      vec4(transmitted(q.absorption_path.xyz, q.absorption_path.w), 0.0));
}
