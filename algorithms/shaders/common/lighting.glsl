// Light on surfaces and in the medium. C++ twin: algorithms/reference/shading.hpp.

const float kPi = 3.14159265358979;
const int kMaxLights = 4;

struct Light {
  vec4 position_kind;    // w: 0 directional, 1 point, 2 spot
  vec4 direction_outer;  // unit, the way the light travels; w: cosine where a spot reaches zero
  vec4 intensity_inner;  // w: cosine of a spot's full cone
};

layout(std140, binding = 0) uniform Lights {
  Light lights[kMaxLights];
  vec4 ambient_count;  // radiance of the ambient light; w: number of lights
};

// Irradiance on a plane at `p` that faces the light, unshadowed; `to_light` becomes the unit vector towards it.
vec3 light_irradiance(Light light, vec3 p, out vec3 to_light) {
  float kind = light.position_kind.w;
  if (kind < 0.5) {
    to_light = -light.direction_outer.xyz;
    return light.intensity_inner.rgb;
  }
  vec3 offset = light.position_kind.xyz - p;
  float distance2 = dot(offset, offset);
  to_light = offset * inversesqrt(distance2);
  float spot = 1.0;
  if (kind > 1.5) {
    spot = smoothstep(light.direction_outer.w, light.intensity_inner.w, dot(-to_light, light.direction_outer.xyz));
  }
  return light.intensity_inner.rgb * (spot / distance2);
}

// Radiance of a Lambertian surface with unit normal `n` turned to the viewer; `visible`: the share of each light that
// reaches it.
vec3 surface_radiance(vec3 p, vec3 n, vec3 albedo, vec3 emission, vec4 visible) {
  vec3 incident = ambient_count.rgb;
  int count = int(ambient_count.w);
  for (int i = 0; i < count; ++i) {
    vec3 to_light;
    vec3 irradiance = light_irradiance(lights[i], p, to_light);
    incident += irradiance * (visible[i] * max(dot(n, to_light), 0.0) / kPi);
  }
  return emission + albedo * incident;
}

// Source radiance of the medium: isotropic single scattering, the phase function neglected as in Imagire et al. 2007, Sec. 5.
vec3 medium_radiance(vec3 p, vec3 albedo, vec3 emission, vec4 visible) {
  vec3 incident = ambient_count.rgb;
  int count = int(ambient_count.w);
  for (int i = 0; i < count; ++i) {
    vec3 to_light;
    incident += light_irradiance(lights[i], p, to_light) * (visible[i] / (4.0 * kPi));
  }
  return emission + albedo * incident;
}
