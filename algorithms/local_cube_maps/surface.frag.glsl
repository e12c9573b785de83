// A mirror, metal or dielectric in localized light (Sec. 3 and 4).
#include "algorithms/local_cube_maps/lookup.glsl"
#include "algorithms/local_cube_maps/surface_point.glsl"
#include "algorithms/shaders/optics.glsl"
#if KIND == 3
#include "algorithms/local_cube_maps/refraction.glsl"
#ifdef SCATTERING
vec3 leaves_at;  // where the light in question leaves
vec3 sharp_radiance(vec3 direction) { return incoming(leaves_at, direction); }
#include "algorithms/shaders/translucency.glsl"
#endif
#endif

#if KIND != 3
uniform vec3 reflectance;
#endif
#if KIND == 2
uniform vec3 metal_n;
uniform vec3 metal_k;
#endif

layout(location = 0) out vec4 radiance;
layout(location = 1) out vec4 eye_distance_m;

#if KIND == 3
#ifdef SCATTERING
vec3 returned = vec3(0.0);  // what the medium has sent back of the path so far
#endif

// The light of what leaves a path at an interface.
vec3 left(inout InnerPath path, vec3 outward, bool last) {
  vec3 before = path.throughput, exit_direction, exit_weight;
  leave(path, outward, last, exit_direction, exit_weight);
#ifdef SCATTERING
  if (before.x <= 0.0) return vec3(0.0);
  leaves_at = path.position;
  return before.x * translucent(extinction * path.way_m, exit_direction, exit_weight.x / before.x, returned);
#else
  return exit_weight * incoming(path.position, exit_direction);
#endif
}

vec3 dielectric(vec3 V, vec3 n, bool inside) {
  float cosine = min(abs(dot(V, n)), 1.0);
  vec3 light = vec3(0.0);
  InnerPath path;
  path.position = world_position;
  path.throughput = vec3(1.0);
#ifdef SCATTERING
  path.way_m = 0.0;
#endif
  if (inside) {  // the eye is in the object: this is already where a path leaves
    path.direction = V;
#ifdef SCATTERING
    path.way_m = distance(eye, world_position);
#else
    path.throughput = transmitted(absorption, distance(eye, world_position));
#endif
    light += left(path, -n, INTERNAL == 0);
#ifdef REFRACTOR
    for (int i = 1; i <= INTERNAL; ++i) {
      vec3 outward;
      go_on(path, outward);
      light += left(path, outward, i == INTERNAL);
    }
#endif
    return light;
  }
  float reflected = fresnel_dielectric(cosine, 1.0 / ior);
  light += reflected * incoming(world_position, reflect(V, n));
  path.throughput *= 1.0 - reflected;
  path.direction = refract(V, n, 1.0 / ior);
  if (reflected >= 1.0) return light;
#ifdef REFRACTOR
  for (int i = 0; i <= INTERNAL; ++i) {
    vec3 outward;
    go_on(path, outward);
    light += left(path, outward, i == INTERNAL);
  }
#else
  light += path.throughput * incoming(world_position, path.direction);
#endif
  return light;
}
#endif

void main() {
  vec3 V;
  if (!fetch_surface(V)) discard;
  bool inside;
  vec3 n = visible_normal(V, inside);
#if KIND == 3
  vec3 light = dielectric(V, n, inside);
#else
  vec3 light = reflectance * incoming(world_position, reflect(V, n));
#if KIND == 2
  light *= fresnel_metal(clamp(-dot(V, n), 0.0, 1.0), metal_n, metal_k);
#endif
#endif
#ifdef DISTANCE_IN_ALPHA
  radiance = vec4(light, distance(eye, world_position));
#else
  radiance = vec4(light, 1.0);
#endif
  eye_distance_m = vec4(distance(eye, world_position));
}
