// The cube maps of a geocube: each face a layer of an array with a border of its neighbours' texels, so that bilinear
// fetches join across the cube's edges. C++ twin: CubeMaps in search.hpp.
layout(binding = 1) uniform sampler2DArray cube_bounds;  // d, cos A, cos B, R_C
layout(binding = 2) uniform sampler2DArray cube_planes;  // N; inner distance, or of a single layer whether more is behind
uniform vec4 cube_spheres[16];                           // centre, and radius of sphere D
uniform int cube_count;
uniform int cube_layers;

struct CubeSample {
  vec4 bounds;
  vec4 plane;  // N is not unit
};

// s, t in [-1, 1] and the face, as OpenGL numbers them.
vec3 cube_point(vec3 d) {
  vec3 a = abs(d);
  if (a.x >= a.y && a.x >= a.z) return vec3((d.x >= 0.0 ? -d.z : d.z) / a.x, -d.y / a.x, d.x >= 0.0 ? 0.0 : 1.0);
  if (a.y >= a.z) return vec3(d.x / a.y, (d.y >= 0.0 ? d.z : -d.z) / a.y, d.y >= 0.0 ? 2.0 : 3.0);
  return vec3((d.z >= 0.0 ? d.x : -d.x) / a.z, -d.y / a.z, d.z >= 0.0 ? 4.0 : 5.0);
}

vec3 cube_coordinates(int cube, vec3 direction) {
  vec3 p = cube_point(direction);
  float size = float(textureSize(cube_bounds, 0).x);
  vec2 uv = ((p.xy * 0.5 + 0.5) * (size - 2.0) + 1.0) / size;
  return vec3(uv, float(cube * cube_layers * 6) + p.z);
}

#ifdef COUNT
int both_fetched = 0, bounds_fetched = 0;
#endif

CubeSample fetch_cube(int cube, vec3 direction) {
#ifdef COUNT
  ++both_fetched;
#endif
  vec3 at = cube_coordinates(cube, direction);
  return CubeSample(textureLod(cube_bounds, at, 0.0), textureLod(cube_planes, at, 0.0));
}
vec4 fetch_bounds(int cube, vec3 direction) {
#ifdef COUNT
  ++bounds_fetched;
#endif
  return textureLod(cube_bounds, cube_coordinates(cube, direction), 0.0);
}
