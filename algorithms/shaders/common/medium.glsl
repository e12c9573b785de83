// The volume's medium at a point in local coordinates [0,1]³.
#include "algorithms/shaders/common/lighting.glsl"
#include "algorithms/shaders/common/opacity.glsl"

layout(binding = 0) uniform sampler3D density_map;
uniform mat4 volume_to_world;
uniform float volume_extinction;  // φ at density 1 [1/m]
uniform vec3 volume_albedo;
uniform vec3 volume_emission;

// Extinction φ [1/m].
float medium_extinction(vec3 local) { return volume_extinction * textureLod(density_map, local, 0.0).r; }

vec3 medium_source(vec3 local) {
#ifdef UNIFORM_SOURCE
  // No light depends on the place, so neither does the source.
  return medium_radiance(vec3(0.0), volume_albedo, volume_emission);
#else
  return medium_radiance((volume_to_world * vec4(local, 1.0)).xyz, volume_albedo, volume_emission);
#endif
}
