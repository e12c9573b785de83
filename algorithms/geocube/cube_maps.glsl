// The cube maps of a geocube: each face a layer of an array with a border of its neighbours' texels, so that bilinear
// fetches join across the cube's edges. C++ twin: CubeMaps in search.hpp.
#include "algorithms/shaders/cube_point.glsl"

layout(binding = 1) uniform sampler2DArray cube_bounds;  // d, cos A, cos B, R_C
layout(binding = 2) uniform sampler2DArray cube_planes;  // N; inner distance, or of a single layer whether more is behind
uniform vec4 cube_spheres[16];                           // centre, and radius of sphere D
uniform int cube_count;
uniform int cube_layers;

struct CubeSample {
  vec4 bounds;
  vec4 plane;  // N is not unit
};

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
