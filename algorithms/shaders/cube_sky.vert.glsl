// A cube about the reference point that carries the environment; drawn beyond the far plane, behind everything.
#if CUBE_PASS == 1
#extension GL_ARB_shader_viewport_layer_array : require
#endif
#include "algorithms/shaders/cube_stage.glsl"

uniform vec3 eye;
uniform float sky_size;

#if CUBE_PASS == 0
out Vertex {
  vec3 position, normal, albedo;
  flat vec3 emission;
} to_faces;
#else
out vec3 world_position;
#endif

void main() {
  // The corners of a cube as one strip of 14 vertices.
  vec3 corner = vec3((0x287a >> gl_VertexID) & 1, (0x02af >> gl_VertexID) & 1, (0x31e3 >> gl_VertexID) & 1);
  vec4 world = vec4(eye + sky_size * (2.0 * corner - 1.0), 1.0);
#if CUBE_PASS == 0
  to_faces.position = world.xyz;
  to_faces.normal = vec3(0.0);
  to_faces.albedo = vec3(0.0);
  to_faces.emission = vec3(0.0);
  gl_Position = world;
#else
  world_position = world.xyz;
  choose_face(world);
#endif
}
