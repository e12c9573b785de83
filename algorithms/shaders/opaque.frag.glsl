// The usual shading of opaque objects.
#include "algorithms/shaders/shadows.glsl"

in vec3 world_position;
in vec3 world_normal;
in vec3 albedo;
flat in vec3 emission;

uniform vec3 eye;

#ifdef SURFACE_POINTS
// The reference shades this by itself.
layout(location = 0) out vec4 point_albedo;
layout(location = 1) out float eye_distance_m;
layout(location = 2) out vec4 point_normal;
layout(location = 3) out vec4 point_emission;
#else
layout(location = 0) out vec4 radiance;
layout(location = 1) out float eye_distance_m;
#endif

void main() {
  // Two-sided: the triangle's own normal tells which side is seen; at a smooth silhouette the interpolated one may not.
  vec3 n = normalize(world_normal);
  vec3 to_eye = eye - world_position;
  vec3 geometric = cross(dFdx(world_position), dFdy(world_position));
  if (dot(geometric, to_eye) < 0.0) geometric = -geometric;
  if (dot(n, geometric) < 0.0) n = -n;
  eye_distance_m = length(to_eye);
#ifdef SURFACE_POINTS
  point_albedo = vec4(albedo, 1.0);
  point_normal = vec4(n, 1.0);
  point_emission = vec4(emission, 1.0);
#else
  radiance = vec4(surface_radiance(world_position, n, albedo, emission, light_visibilities(world_position)), 1.0);
#ifdef DISTANCE_IN_ALPHA
  radiance.a = eye_distance_m;
#endif
#endif
}
