// A mirror, metal or dielectric in localized light (Sec. 3 and 4).
#include "algorithms/distance_impostors/lookup.glsl"
#include "algorithms/distance_impostors/surface_point.glsl"
#include "algorithms/shaders/optics.glsl"
#if KIND == 3
#include "algorithms/distance_impostors/refraction.glsl"
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
vec3 dielectric(vec3 V, vec3 n, bool inside) {
  float cosine = min(abs(dot(V, n)), 1.0);
  vec3 light = vec3(0.0);
  InnerPath path;
  path.position = world_position;
  path.throughput = vec3(1.0);
  vec3 exit_direction, exit_weight;
  if (inside) {  // the eye is in the object: this is already where a path leaves
    path.direction = V;
    path.throughput = transmitted(absorption, distance(eye, world_position));
    leave(path, -n, INTERNAL == 0, exit_direction, exit_weight);
    light += exit_weight * incoming(world_position, exit_direction);
#ifdef REFRACTOR
    for (int i = 1; i <= INTERNAL; ++i) {
      vec3 outward;
      go_on(path, outward);
      leave(path, outward, i == INTERNAL, exit_direction, exit_weight);
      light += exit_weight * incoming(path.position, exit_direction);
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
    leave(path, outward, i == INTERNAL, exit_direction, exit_weight);
    light += exit_weight * incoming(path.position, exit_direction);
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
