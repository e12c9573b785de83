// Where rays enter the objects: the search runs in a pass of its own over whole pixels, since triangles may be smaller than
// one. A record of four numbers, for the passes are bound by memory: depth, normal, and whose entry it is.
#include "algorithms/geocube/entry.glsl"
#include "algorithms/shaders/common/octahedron.glsl"

in vec3 object_normal;
#ifdef SPLIT
in float cleared;
flat in int last_cube;
#endif

layout(std430, binding = 2) readonly buffer FirstCubes { uint first_cubes[]; };  // by triangle, four to a word
uniform int object_number;                                                       // from 1

layout(location = 0) out vec4 entry;
#ifdef SPLIT
layout(location = 1) out vec4 entry_cleared;
#endif

void main() {
#ifdef SPLIT
  int cube = last_cube;
  entry_cleared = vec4(cleared, 0.0, 0.0, 0.0);
#else
  uint word = first_cubes[gl_PrimitiveID >> 2];
  int cube = int(word >> uint(8 * (gl_PrimitiveID & 3)) & 255u);
#endif
  entry = vec4(1.0 / gl_FragCoord.w, to_square(object_normal), entry_tag(object_number, cube));
}
