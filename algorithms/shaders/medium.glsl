// The volume's medium at a point in local coordinates [0,1]³, and light in it along a viewing ray.
#include "algorithms/shaders/opacity.glsl"
#include "algorithms/shaders/shadows.glsl"
#define MEDIUM_RAY in
#include "algorithms/shaders/medium_ray.glsl"

layout(binding = 0) uniform sampler3D density_map;  // in a unit that fits 16-bit floats
#ifdef TRANSFER
layout(binding = 3) uniform sampler2D transfer_map;  // rgb: albedo, a: φ; one row over the densities
#endif
#ifdef LIGHT_SPACE
// The volume lies in a spotlight's space and stores what that light sends to each voxel, per unit of its intensity
// (Imagire et al. 2007, Sec. 5 and Fig. 11).
layout(binding = 4) uniform sampler3D scattering_map;
#endif

struct MediumPoint {
  float extinction;  // φ [1/m]
  vec3 albedo;       // times the volume's own
};

MediumPoint medium_at(vec3 p) {
  float density = textureLod(density_map, p, 0.0).r;
#ifdef TRANSFER
  // Beyond the map's ends its first and last texels go on.
  vec4 mapped = textureLod(transfer_map, vec2(density * transfer_place.x + transfer_place.y, 0.5), 0.0);
  return MediumPoint(map_extinction * mapped.a, mapped.rgb);
#else
  return MediumPoint(map_extinction * density, vec3(1.0));
#endif
}

// A light along the ray. At t metres behind the path's beginning it sees the point at `place + t·place_per_m`
// (light_place()), and the squared distance is (t − foot_m)² + foot2.
struct RayLight {
  vec3 place, place_per_m;
  float foot_m;  // where the ray passes it nearest
  float foot2;
};

struct MediumPath {
  vec3 front, front_per_m;  // local coordinates of the beginning, and one metre along the ray
#if MEDIUM_LIGHTS > 0
  RayLight lights[MEDIUM_LIGHTS];
#endif
};

// The path that begins `begin_m` from the eye at `front` (local coordinates), on the ray through the fragment.
MediumPath medium_path(vec3 front, float begin_m) {
  MediumPath path;
  float per_m = inversesqrt(dot(from_eye, from_eye));
  vec3 ray = from_eye * per_m;
  path.front = front;
  path.front_per_m = local_from_eye * per_m;
#if MEDIUM_LIGHTS > 0
  for (int k = 0; k < MEDIUM_LIGHTS; ++k) {
    path.lights[k].place_per_m = place_from_eye[k] * per_m;
    path.lights[k].place = eye_place[k] + begin_m * path.lights[k].place_per_m;
    float foot_m = -dot(eye_from_light[k], ray);
    vec3 foot = eye_from_light[k] + foot_m * ray;
    path.lights[k].foot_m = foot_m - begin_m;
    path.lights[k].foot2 = max(dot(foot, foot), scattered_light[k].w);
  }
#endif
  return path;
}

vec3 medium_place(MediumPath path, float t) { return path.front + t * path.front_per_m; }

#if MEDIUM_LIGHTS > 0
vec3 place_at(RayLight light, float t) { return light.place + t * light.place_per_m; }
float squared_distance(RayLight light, float t) { return (t - light.foot_m) * (t - light.foot_m) + light.foot2; }
#endif

// Share of each light that reaches the point at t.
vec4 medium_visibility(MediumPath path, float t) {
  vec4 visible = vec4(1.0);
#if MEDIUM_LIGHTS > 0 && defined(SHADOWS)
  for (int k = 0; k < MEDIUM_LIGHTS; ++k) {
    if (casts_shadow(FIRST_LIGHT + k)) {
      float distance = sqrt(squared_distance(path.lights[k], t));
      visible[k] = shadow_share(FIRST_LIGHT + k, place_at(path.lights[k], t), distance, cone_range[k].zw, shadow_settings);
    }
  }
#endif
  return visible;
}

// Source radiance C0 at t where `visible` is the share of each light that reaches it: isotropic single scattering, the
// phase function neglected as in Imagire et al. 2007, Sec. 5. C++ twin: algorithms/reference/shading.hpp.
vec3 medium_source(MediumPath path, float t, vec3 albedo, vec4 visible) {
#ifdef UNIFORM_SOURCE
  return source_everywhere;
#else
  vec3 scattered = scattered_ambient;
#if defined(LIGHT_SPACE)
  scattered += scattered_light[0].rgb * (visible[0] * textureLod(scattering_map, medium_place(path, t), 0.0).r);
#elif MEDIUM_LIGHTS > 0
  for (int k = 0; k < MEDIUM_LIGHTS; ++k) {
    float share = visible[k];
    if (kLightKinds[k] != kDirectional) {
      float per_m = 1.0 / sqrt(squared_distance(path.lights[k], t));
      share *= per_m * per_m;
      if (kLightKinds[k] == kSpot) {
        float c = clamp(place_at(path.lights[k], t).z * per_m * cone_range[k].x + cone_range[k].y, 0.0, 1.0);
        share *= c * c * (3.0 - 2.0 * c);
      }
    }
    scattered += scattered_light[k].rgb * share;
  }
#endif
  return emitted + albedo * scattered;
#endif
}
