// An optical object in its own space.
#ifdef SPLIT
#include "algorithms/geocube/search.glsl"
uniform int vertex_iterations;
uniform float relative_index;  // before the interface over behind it
#endif
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float first_cube;

uniform mat4 object_to_clip;
uniform vec3 eye;  // in the object's space

// The passes over the same geometry must agree in depth to the bit.
invariant gl_Position;
out vec3 object_position;
out vec3 object_normal;
flat out int last_cube;  // of all vertices of a triangle; if the stage is split, where the provoking vertex's ray is
#ifdef SPLIT
out float cleared;  // how far the vertex's own ray is known to run inside
#endif

void main() {
  object_position = position;
  object_normal = normal;
  last_cube = int(first_cube);
  gl_Position = object_to_clip * vec4(position, 1.0);
#ifdef SPLIT
  // The paper's vertex stage: most of the way; the fragment stage goes on from between the vertices' points.
  vec3 n = normalize(normal), v = normalize(position - eye);
  cleared = 0.0;
  vec3 h = refract(v, n, relative_index);
  if (dot(v, n) < 0.0 && h != vec3(0.0)) {
    float t = first_step(position, n, h, last_cube), inside = t;
    int steps = 0;
    bool found;
    vec3 along;
    CubeSample s;
    march(position, h, vertex_iterations, last_cube, t, inside, steps, found, along, s);
    cleared = inside;
  }
#endif
}
