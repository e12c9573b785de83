// Directions, of any length but 0, on the square that an octahedron unfolds to, [−1, 1]² (references.bib: meyer2010).
vec2 to_square(vec3 n) {
  vec2 upper = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
  vec2 side = mix(vec2(-1.0), vec2(1.0), greaterThanEqual(upper, vec2(0.0)));
  return n.z >= 0.0 ? upper : (1.0 - abs(upper.yx)) * side;
}

vec3 from_square(vec2 p) {
  vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
  vec2 side = mix(vec2(-1.0), vec2(1.0), greaterThanEqual(p, vec2(0.0)));
  if (n.z < 0.0) n.xy = (1.0 - abs(p.yx)) * side;
  return normalize(n);
}
