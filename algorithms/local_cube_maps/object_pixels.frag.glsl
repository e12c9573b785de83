// The first pass over mirrors, metals and dielectrics: which surface a pixel shows.
#include "algorithms/local_cube_maps/surface_point.glsl"

uniform int object_number;

layout(location = 0) out vec4 object_pixel;

void main() {
  vec3 from_eye = world_position - eye;
  float eye_distance = length(from_eye);
  bool inside;
  vec3 n = visible_normal(from_eye / eye_distance, inside);
  object_pixel = vec4(to_square(n), eye_distance, float(inside ? -object_number : object_number));
}
