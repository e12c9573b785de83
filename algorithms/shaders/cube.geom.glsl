// Sends each triangle to the faces of the cube map that may see it, one invocation a face.
layout(triangles, invocations = 6) in;
layout(triangle_strip, max_vertices = 3) out;

uniform mat4 world_to_face[6];

in Vertex {
  vec3 position, normal, albedo;
  flat vec3 emission;
} vertices[];

out vec3 world_position;
out vec3 world_normal;
out vec3 albedo;
flat out vec3 emission;

bool beyond(vec3 a, vec3 b) { return all(greaterThan(a, b)); }

void main() {
  mat4 to_clip = world_to_face[gl_InvocationID];
  vec4 a = to_clip * gl_in[0].gl_Position, b = to_clip * gl_in[1].gl_Position, c = to_clip * gl_in[2].gl_Position;
  vec3 x = vec3(a.x, b.x, c.x), y = vec3(a.y, b.y, c.y), z = vec3(a.z, b.z, c.z), w = vec3(a.w, b.w, c.w);
  if (beyond(x, w) || beyond(-x, w) || beyond(y, w) || beyond(-y, w) || beyond(-z, w)) return;
  for (int i = 0; i < 3; ++i) {
    world_position = vertices[i].position;
    world_normal = vertices[i].normal;
    albedo = vertices[i].albedo;
    emission = vertices[i].emission;
    gl_Layer = gl_InvocationID;
    gl_Position = i == 0 ? a : i == 1 ? b : c;
    EmitVertex();
  }
  EndPrimitive();
}
