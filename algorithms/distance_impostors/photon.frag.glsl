// A photon: the light that a texel of the photon map sends on, and where it lands (Sec. 5). exit_index: −1 what is
// reflected on the outside, i what leaves after i reflections inside.
#include "algorithms/local_cube_maps/lookup.glsl"
#include "algorithms/local_cube_maps/surface_point.glsl"
#include "algorithms/shaders/optics.glsl"
#if KIND == 3
#include "algorithms/local_cube_maps/refraction.glsl"
#endif

#if KIND != 3
uniform vec3 reflectance;
#endif
#if KIND == 2
uniform vec3 metal_n;
uniform vec3 metal_k;
#endif
uniform int exit_index;
uniform int light_kind;  // 0 directional, 1 point, 2 spot
uniform vec3 light_position;
uniform vec3 light_direction;
uniform vec3 light_intensity;
uniform vec2 light_cone;  // cosines: where a spot is nothing, where it is full
uniform vec3 view_axis;
uniform float texel;  // side: on the plane at distance 1, or [m] of a directional light's

layout(binding = 8) uniform samplerCube places;

layout(location = 0) out vec4 photon_place;
layout(location = 1) out vec4 photon_power;

// Power [W] through this texel: intensity times solid angle, or irradiance times area.
vec3 texel_power(vec3 L) {
  if (light_kind == 0) return light_intensity * (texel * texel);
  float c = dot(L, view_axis);
  float spot = light_kind == 2 ? smoothstep(light_cone.x, light_cone.y, dot(L, light_direction)) : 1.0;
  return light_intensity * (spot * texel * texel * c * c * c);
}

// Between texels of one part of one receiver a place is interpolated; at a border any of them is taken.
vec4 place_at(vec3 l) {
  vec4 parts = textureGather(places, l, 2);
  if (parts == parts.xxxx) {
    vec4 smooth_place = textureLod(places, l, 0.0);
    return vec4(smooth_place.xy, parts.x, smooth_place.w);
  }
  vec4 u = textureGather(places, l, 0), v = textureGather(places, l, 1), area = textureGather(places, l, 3);
  for (int i = 0; i < 4; ++i) {
    if (parts[i] >= 0.0) return vec4(u[i], v[i], parts[i], area[i]);
  }
  return vec4(0.0, 0.0, -1.0, 0.0);
}

// The path to the wanted exit; false where there is none.
bool follow(vec3 L, vec3 n, out vec3 from, out vec3 R, out vec3 share) {
  from = world_position;
  float cosine = clamp(-dot(L, n), 0.0, 1.0);
#if KIND == 3
  float reflected = fresnel_dielectric(cosine, 1.0 / ior);
  if (exit_index < 0) {
    R = reflect(L, n);
    share = vec3(reflected);
    return true;
  }
  if (reflected >= 1.0) return false;
  InnerPath path;
  path.position = world_position;
  path.direction = refract(L, n, 1.0 / ior);
  path.throughput = vec3(1.0 - reflected);
#ifdef REFRACTOR
  for (int i = 0; i <= exit_index; ++i) {
    vec3 outward;
    go_on(path, outward);
    leave(path, outward, i == INTERNAL, R, share);
  }
  from = path.position;
#else
  R = path.direction;
  share = path.throughput;
#endif
  return true;
#else
  R = reflect(L, n);
  share = reflectance;
#if KIND == 2
  share *= fresnel_metal(cosine, metal_n, metal_k);
#endif
  return true;
#endif
}

void main() {
  vec3 L = light_kind == 0 ? light_direction : normalize(world_position - light_position);
  bool inside;
  vec3 n = visible_normal(L, inside);
  photon_place = vec4(0.0, 0.0, -1.0, 0.0);
  photon_power = vec4(0.0);
  vec3 from, R, share;
  if (inside || !follow(L, n, from, R, share)) return;
  vec3 power = texel_power(L) * share;
  photon_place = place_at(environment_hit(from - reference_point, R));
  photon_power = vec4(power, 1.0);
}
