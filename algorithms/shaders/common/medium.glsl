// The volume's medium at a point in local coordinates [0,1]³.
#include "algorithms/shaders/common/opacity.glsl"
#include "algorithms/shaders/common/shadows.glsl"

layout(binding = 0) uniform sampler3D density_map;
uniform mat4 volume_to_world;
uniform float volume_extinction;  // φ at density 1 [1/m]
uniform vec3 volume_albedo;
uniform vec3 volume_emission;

// Extinction φ [1/m].
float medium_extinction(vec3 local) { return volume_extinction * textureLod(density_map, local, 0.0).r; }

vec3 medium_world(vec3 local) { return (volume_to_world * vec4(local, 1.0)).xyz; }

// Source radiance C0 where `visible` is the share of each light that reaches the point.
vec3 medium_source(vec3 local, vec4 visible) {
#ifdef UNIFORM_SOURCE
  // No light depends on the place, so neither does the source.
  return medium_radiance(vec3(0.0), volume_albedo, volume_emission, vec4(1.0));
#else
  return medium_radiance(medium_world(local), volume_albedo, volume_emission, visible);
#endif
}

vec4 medium_visibility(vec3 local) {
#ifdef SHADOWS
  return light_visibilities(medium_world(local));
#else
  return vec4(1.0);
#endif
}
