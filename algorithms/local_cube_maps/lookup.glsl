// The light that arrives at a point from a direction, out of the cube map about a reference point. PARALLAX: 0 none, as
// classical environment mapping, 1 a box and 2 a sphere as proxy (Bjorke 2004), 3 the distance impostor.
layout(binding = 4) uniform samplerCube radiance_cube;
layout(binding = 5) uniform samplerCube distance_cube;  // its alpha
uniform vec3 reference_point;                           // o, in the world

#if PARALLAX == 1
uniform vec3 proxy_min;  // about o
uniform vec3 proxy_max;

vec3 environment_hit(vec3 x, vec3 R) {
  vec3 slope = mix(R, vec3(1e-9), lessThan(abs(R), vec3(1e-9)));
  vec3 leave = max((proxy_min - x) / slope, (proxy_max - x) / slope);
  return x + R * max(min(leave.x, min(leave.y, leave.z)), 0.0);
}
#elif PARALLAX == 2
uniform float proxy_radius;

vec3 environment_hit(vec3 x, vec3 R) {
  float along = dot(x, R);
  return x + R * max(sqrt(max(along * along - dot(x, x) + proxy_radius * proxy_radius, 0.0)) - along, 0.0);
}
#elif PARALLAX == 3
#include "algorithms/local_cube_maps/hit_search.glsl"

vec3 environment_hit(vec3 x, vec3 R) { return find_hit(x, R, distance_cube); }
#else
vec3 environment_hit(vec3 x, vec3 R) { return R; }
#endif

vec3 incoming(vec3 position, vec3 R) {
  return textureLod(radiance_cube, environment_hit(position - reference_point, R), 0.0).rgb;
}
