// The volume's medium at a point in local coordinates [0,1]³.
#include "algorithms/shaders/common/opacity.glsl"
#include "algorithms/shaders/common/shadows.glsl"

layout(binding = 0) uniform sampler3D density_map;
uniform mat4 volume_to_world;
uniform float volume_extinction;  // φ at density 1 [1/m]
uniform vec3 volume_albedo;
uniform vec3 volume_emission;
#ifdef UNIFORM_SOURCE
uniform vec3 uniform_source;  // no light depends on the place, so neither does C0: it is computed once
#endif

#ifdef TRANSFER
layout(binding = 3) uniform sampler2D transfer_map;  // rgb: albedo, a: φ; one row over the densities of transfer_range
uniform vec2 transfer_range;                         // x: least density, y: 1 / (greatest − least)
#endif
#ifdef LIGHT_SPACE
// The volume lies in a spotlight's space and stores what that light sends to each voxel, per unit of its intensity
// (Imagire et al. 2007, Sec. 5 and Fig. 11).
layout(binding = 4) uniform sampler3D scattering_map;
uniform int volume_light;
#endif

struct MediumPoint {
  float extinction;  // φ [1/m]
  vec3 albedo;
};

MediumPoint medium_at(vec3 local) {
  float density = textureLod(density_map, local, 0.0).r;
#ifdef TRANSFER
  float texels = float(textureSize(transfer_map, 0).x);
  float u = clamp((density - transfer_range.x) * transfer_range.y, 0.0, 1.0);
  vec4 mapped = textureLod(transfer_map, vec2((u * (texels - 1.0) + 0.5) / texels, 0.5), 0.0);
  return MediumPoint(volume_extinction * mapped.a, volume_albedo * mapped.rgb);
#else
  return MediumPoint(volume_extinction * density, volume_albedo);
#endif
}

vec3 medium_world(vec3 local) { return (volume_to_world * vec4(local, 1.0)).xyz; }

// Source radiance C0 where `visible` is the share of each light that reaches the point.
vec3 medium_source(vec3 local, vec3 albedo, vec4 visible) {
#if defined(UNIFORM_SOURCE)
  return uniform_source;
#elif defined(LIGHT_SPACE)
  float irradiance = textureLod(scattering_map, local, 0.0).r * visible[volume_light];
  return volume_emission + albedo * (ambient_count.rgb + lights[volume_light].intensity_inner.rgb * (irradiance / (4.0 * kPi)));
#else
  return medium_radiance(medium_world(local), albedo, volume_emission, visible);
#endif
}

vec4 medium_visibility(vec3 local) {
#if defined(SHADOWS) && defined(LIGHT_SPACE)
  vec4 visible = vec4(1.0);
  visible[volume_light] = light_visibility(volume_light, medium_world(local));
  return visible;
#elif defined(SHADOWS)
  return light_visibilities(medium_world(local));
#else
  return vec4(1.0);
#endif
}
