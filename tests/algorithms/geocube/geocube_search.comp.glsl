// Runs the geocube's searches on the inputs of the test.
#include "algorithms/geocube/search.glsl"

layout(local_size_x = 64) in;

struct Input {
  vec4 point_cube;
  vec4 normal;
  vec4 direction;
  vec4 functions;  // f, h.a, h.n, mu
};
struct Output {
  vec4 point_length;
  vec4 normal_steps;
  vec4 cube_bounded_cone_sphere;
  vec4 bounds;
};
layout(std430, binding = 0) readonly buffer Inputs { Input inputs[]; };
layout(std430, binding = 1) writeonly buffer Outputs { Output outputs[]; };

void main() {
  uint k = gl_GlobalInvocationID.x;
  if (k >= inputs.length()) return;
  Input q = inputs[k];
  int cube = int(q.point_cube.w);
  float start = first_step(q.point_cube.xyz, q.normal.xyz, q.direction.xyz, cube);
  Exit e = trace_inside(q.point_cube.xyz, q.normal.xyz, q.direction.xyz, cube, start);
  outputs[k] = Output(vec4(e.point, e.path), vec4(e.normal, float(e.steps)),
                      vec4(float(e.cube), e.bounded ? 1.0 : 0.0,
                           cone_step(q.functions.x, q.functions.y, q.functions.z, 0.8, q.functions.w),
                           sphere_step(q.functions.x, q.functions.y)),
                      fetch_cube(cube, q.direction.xyz).bounds);
}
