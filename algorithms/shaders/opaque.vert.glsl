// Opaque objects, instanced.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 color;
layout(location = 3) in vec4 to_world_0;
layout(location = 4) in vec4 to_world_1;
layout(location = 5) in vec4 to_world_2;
layout(location = 6) in vec4 to_world_3;
layout(location = 7) in vec3 normal_to_world_0;
layout(location = 8) in vec3 normal_to_world_1;
layout(location = 9) in vec3 normal_to_world_2;
layout(location = 10) in vec3 instance_albedo;
layout(location = 11) in vec3 instance_emission;

uniform mat4 world_to_clip;

// The passes over the same geometry must agree in depth to the bit.
invariant gl_Position;
out vec3 world_position;
out vec3 world_normal;
out vec3 albedo;
flat out vec3 emission;

void main() {
  vec4 world = mat4(to_world_0, to_world_1, to_world_2, to_world_3) * vec4(position, 1.0);
  world_position = world.xyz;
  world_normal = mat3(normal_to_world_0, normal_to_world_1, normal_to_world_2) * normal;
  albedo = color * instance_albedo;
  emission = instance_emission;
  gl_Position = world_to_clip * world;
}
