// Depth moments of the nearest occluder (Donnelly and Lauritzen 2006, Sec. 3).
in vec3 world_position;

uniform vec3 light_origin;
uniform vec3 light_axis;  // zero where depth is a distance
uniform float inverse_range;

layout(location = 0) out vec2 moments;

void main() {
  vec3 from_light = world_position - light_origin;
  float depth = (light_axis == vec3(0.0) ? length(from_light) : dot(from_light, light_axis)) * inverse_range;
  // A texel covers a slope: the variance within it, from the derivatives.
  float dx = dFdx(depth), dy = dFdy(depth);
  moments = vec2(depth, depth * depth + 0.25 * (dx * dx + dy * dy));
}
