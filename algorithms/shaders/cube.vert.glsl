// Objects, instanced, into the faces of a cube map. CUBE_PASS: 0 a geometry shader chooses the layers, 1 this shader does,
// each instance drawn for one face after the other, 2 one face in a pass.
#if CUBE_PASS == 1
#extension GL_ARB_shader_viewport_layer_array : require
#endif
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

#include "algorithms/shaders/cube_stage.glsl"

#if CUBE_PASS == 0
out Vertex {
  vec3 position, normal, albedo;
  flat vec3 emission;
} to_faces;
#else
out vec3 world_position;
out vec3 world_normal;
out vec3 albedo;
flat out vec3 emission;
#endif

void main() {
  vec4 world = mat4(to_world_0, to_world_1, to_world_2, to_world_3) * vec4(position, 1.0);
  vec3 turned = mat3(normal_to_world_0, normal_to_world_1, normal_to_world_2) * normal;
#if CUBE_PASS == 0
  to_faces.position = world.xyz;
  to_faces.normal = turned;
  to_faces.albedo = color * instance_albedo;
  to_faces.emission = instance_emission;
  gl_Position = world;
#else
  world_position = world.xyz;
  world_normal = turned;
  albedo = color * instance_albedo;
  emission = instance_emission;
  choose_face(world);
#endif
}
