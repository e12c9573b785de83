// The point of a mirror, metal or dielectric that a fragment shows. KIND: 1 mirror, 2 metal, 3 dielectric.
in vec3 world_position;
in vec3 world_normal;

uniform vec3 eye;

// The unit normal on the viewer's side, as the forward pass has it, and whether that is the inside.
vec3 visible_normal(vec3 V, out bool inside) {
  vec3 n = normalize(world_normal);
  vec3 geometric = cross(dFdx(world_position), dFdy(world_position));
  if (dot(geometric, V) > 0.0) geometric = -geometric;
  inside = dot(n, geometric) < 0.0;
  return inside ? -n : n;
}
