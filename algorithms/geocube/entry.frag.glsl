// Where rays enter the objects: the search runs in a pass of its own over whole pixels, since triangles may be smaller than
// one.
in vec3 object_position;
in vec3 object_normal;
#ifdef SPLIT
in float cleared;
flat in int last_cube;
#endif

layout(std430, binding = 2) readonly buffer FirstCubes { uint first_cubes[]; };  // by triangle, four to a word
uniform float object_number;                                                     // from 1

layout(location = 0) out vec4 entry_point;   // in the object's space, and the first cube
layout(location = 1) out vec4 entry_normal;  // not unit; object's number, 0 where there is none
#ifdef SPLIT
layout(location = 2) out vec4 entry_cleared;
#endif

void main() {
#ifdef SPLIT
  int cube = last_cube;
  entry_cleared = vec4(cleared, 0.0, 0.0, 0.0);
#else
  uint word = first_cubes[gl_PrimitiveID >> 2];
  int cube = int(word >> uint(8 * (gl_PrimitiveID & 3)) & 255u);
#endif
  entry_point = vec4(object_position, float(cube));
  entry_normal = vec4(object_normal, object_number);
}
