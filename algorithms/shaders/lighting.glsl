// Light on surfaces and in the medium. C++ twin: algorithms/reference/shading.hpp.

const float kPi = 3.14159265358979;
const int kMaxLights = 4;

// Number and kinds of the lights are compiled in, so that loops over them unroll and no branch is left of their kinds.
#ifndef LIGHT_COUNT
#error "lights need the defines of ForwardPass::light_defines()"
#endif
const int kDirectional = 0, kPoint = 1, kSpot = 2;
const int kLightKinds[kMaxLights] = int[](LIGHT_KINDS);

// 1/r² has no bound, a frame of 16-bit floats has one: a Lambertian surface under this irradiance, and a point of the medium
// between four such lights, send 65504. A lamp of 100 W/sr grows no brighter nearer than 2 cm; the reference has no bound.
const float kGreatestIrradiance = 65504.0 * kPi;

struct Light {
  vec4 position_kind;    // w: as kLightKinds
  vec4 direction_outer;  // unit, the way the light travels; w: cosine where a spot reaches zero
  vec4 intensity_inner;  // w: cosine of a spot's full cone
};

layout(std140, binding = 0) uniform Lights {
  Light lights[kMaxLights];
  vec4 ambient_count;  // radiance of the ambient light; w: number of lights
};

// Irradiance on a plane at `p` that faces the i-th light, unshadowed; `to_light` becomes the unit vector towards it.
vec3 light_irradiance(int i, vec3 p, out vec3 to_light) {
  Light light = lights[i];
  if (kLightKinds[i] == kDirectional) {
    to_light = -light.direction_outer.xyz;
    return light.intensity_inner.rgb;
  }
  vec3 offset = light.position_kind.xyz - p;
  float distance2 = max(dot(offset, offset), 1e-12);  // at the lamp itself no direction leads to it
  to_light = offset * inversesqrt(distance2);
  float spot = 1.0;
  if (kLightKinds[i] == kSpot) {
    spot = smoothstep(light.direction_outer.w, light.intensity_inner.w, dot(-to_light, light.direction_outer.xyz));
  }
  return min(light.intensity_inner.rgb * (spot / distance2), vec3(kGreatestIrradiance));
}

// Radiance of a Lambertian surface with unit normal `n` turned to the viewer; `visible`: the share of each light that
// reaches it.
vec3 surface_radiance(vec3 p, vec3 n, vec3 albedo, vec3 emission, vec4 visible) {
  vec3 incident = ambient_count.rgb;
  for (int i = 0; i < LIGHT_COUNT; ++i) {
    vec3 to_light;
    vec3 irradiance = light_irradiance(i, p, to_light);
    incident += irradiance * (visible[i] * max(dot(n, to_light), 0.0) / kPi);
  }
  return emission + albedo * incident;
}
