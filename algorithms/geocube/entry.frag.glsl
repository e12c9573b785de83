// Where rays enter the objects: the search runs in a pass of its own over whole pixels, since triangles may be smaller than
// one. A record of four numbers, for the passes are bound by memory: depth, normal, and whose entry it is.
#include "algorithms/geocube/entry.glsl"
#include "algorithms/shaders/octahedron.glsl"

in vec3 object_normal;
flat in int last_cube;
#ifdef SPLIT
in float cleared;
#endif

uniform int object_number;  // from 1

layout(location = 0) out vec4 entry;
#ifdef SPLIT
layout(location = 1) out vec4 entry_cleared;
#endif

void main() {
#ifdef SPLIT
  entry_cleared = vec4(cleared, 0.0, 0.0, 0.0);
#endif
  entry = vec4(1.0 / gl_FragCoord.w, to_square(object_normal), entry_tag(object_number, last_cube));
}
