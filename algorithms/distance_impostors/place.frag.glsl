// The map of places (Sec. 5, "uvmap"): where on which receiver's light map a direction ends. In the stead of a normal comes
// the place, see caustics.cpp.
in vec3 world_position;
in vec3 world_normal;

layout(location = 0) out vec4 place;  // u, v; receiver and part; area that the unit square of its light map stands for [m²]

void main() {
  vec2 x = dFdx(world_normal.xy), y = dFdy(world_normal.xy);
  float square = abs(x.x * y.y - x.y * y.x);
  float area = length(cross(dFdx(world_position), dFdy(world_position)));
  place = vec4(world_normal.xy, round(world_normal.z * 1024.0) / 1024.0, square > 0.0 ? area / square : 0.0);
}
