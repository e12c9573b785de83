// A pixel's entry: depth along the view's axis [m], normal as a point of the octahedron, and a tag of object and cube; tag 0
// where there is none.
const int kCubesOfTag = 16;  // kMaxCubes

float entry_tag(int object_number, int cube) { return float(object_number * kCubesOfTag + cube); }
int tagged_object(float tag) { return int(tag) / kCubesOfTag; }
int tagged_cube(float tag) { return int(tag) % kCubesOfTag; }

// A direction of any length on the octahedron |x| + |y| + |z| = 1, unfolded onto [-1, 1]^2 (Meyer et al. 2010).
vec2 octahedral(vec3 n) {
  n /= abs(n.x) + abs(n.y) + abs(n.z);
  vec2 sides = vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);
  return n.z >= 0.0 ? n.xy : (1.0 - abs(n.yx)) * sides;
}
vec3 from_octahedral(vec2 e) {
  vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
  float fold = max(-n.z, 0.0);
  n.xy -= vec2(n.x >= 0.0 ? fold : -fold, n.y >= 0.0 ? fold : -fold);
  return normalize(n);
}
