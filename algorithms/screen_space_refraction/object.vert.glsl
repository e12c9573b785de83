// A closed object with its thickness along the inward normal.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float normal_depth;  // d_N, in the object's own units

uniform mat4 to_world;
uniform mat3 normal_to_world;
uniform mat4 world_to_clip;

// The passes over the same geometry must agree in depth to the bit.
invariant gl_Position;
out vec3 world_position;
out vec3 world_normal;
out float normal_depth_m;

void main() {
  vec4 world = to_world * vec4(position, 1.0);
  world_position = world.xyz;
  world_normal = normal_to_world * normal;
  normal_depth_m = length(mat3(to_world) * (normalize(normal) * normal_depth));
  gl_Position = world_to_clip * world;
}
