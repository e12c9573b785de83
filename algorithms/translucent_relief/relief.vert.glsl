// A mesh that carries a relief.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 color;
layout(location = 3) in vec2 uv;
layout(location = 4) in vec3 over_u;
layout(location = 5) in vec3 over_v;

uniform mat4 to_world;
uniform mat3 normal_to_world;
uniform mat4 world_to_clip;

out vec3 world_position;
out vec3 world_normal;
out vec3 world_over_u;  // metres over a unit of u
out vec3 world_over_v;
out vec3 tint;
out vec2 mesh_uv;

void main() {
  vec4 world = to_world * vec4(position, 1.0);
  world_position = world.xyz;
  world_normal = normal_to_world * normal;
  world_over_u = mat3(to_world) * over_u;
  world_over_v = mat3(to_world) * over_v;
  tint = color;
  mesh_uv = uv;
  gl_Position = world_to_clip * world;
}
