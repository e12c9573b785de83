// Looks key maps up for the test.
vec3 sharp_radiance(vec3 direction) { return vec3(0.0); }
#include "algorithms/shaders/translucency.glsl"

layout(local_size_x = 64) in;

struct Input {
  vec4 direction;
  vec4 level;
};
layout(std430, binding = 0) readonly buffer Inputs { Input inputs[]; };
layout(std430, binding = 1) writeonly buffer Outputs { vec4 outputs[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= inputs.length()) return;
  outputs[i] = vec4(blurred(inputs[i].direction.xyz, inputs[i].level.xyz), 0.0);
}
