// A texel of a refractor map: the outward normal and the distance from the centre, in the mesh's space.
in vec3 world_position;
in vec3 world_normal;

uniform vec3 eye;

layout(location = 0) out vec4 normal_distance;

void main() {
  vec3 from_center = world_position - eye;
  // The nearest surface around the centre is left, not entered, there.
  vec3 geometric = cross(dFdx(world_position), dFdy(world_position));
  if (dot(geometric, from_center) < 0.0) geometric = -geometric;
  vec3 n = normalize(world_normal);
  normal_distance = vec4(dot(n, geometric) < 0.0 ? -n : n, length(from_center));
}
