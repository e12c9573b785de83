// s, t in [-1, 1] and the face, as OpenGL numbers them.
vec3 cube_point(vec3 d) {
  vec3 a = abs(d);
  if (a.x >= a.y && a.x >= a.z) return vec3((d.x >= 0.0 ? -d.z : d.z) / a.x, -d.y / a.x, d.x >= 0.0 ? 0.0 : 1.0);
  if (a.y >= a.z) return vec3(d.x / a.y, (d.y >= 0.0 ? d.z : -d.z) / a.y, d.y >= 0.0 ? 2.0 : 3.0);
  return vec3((d.z >= 0.0 ? d.x : -d.x) / a.z, -d.y / a.z, d.z >= 0.0 ? 4.0 : 5.0);
}
