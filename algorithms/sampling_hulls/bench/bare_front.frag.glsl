// The bench's front faces of a hull: the texture fetches of sampling_hulls/front.frag.glsl and its one blend, and as
// little else as lets the compiler drop none of them. Coordinates are one addition each; no valid path, no transforms,
// no opacity.
in vec3 local;

layout(binding = 0) uniform sampler3D density_map;
layout(binding = 1) uniform sampler2D coordinates_map;
#if SHADOW_FETCHES > 0
layout(binding = 2) uniform sampler2DArray shadow_moments;
#endif
#ifdef TRANSFER
layout(binding = 3) uniform sampler2D transfer_map;
#endif
#ifdef LIGHT_SPACE
layout(binding = 4) uniform sampler3D scattering_map;
#endif
uniform vec3 step_local;  // the same for all pixels: N of them are as deep as a hull

layout(location = 0) out vec4 mean;

void main() {
  vec4 sum = texelFetch(coordinates_map, ivec2(gl_FragCoord.xy), 0);
  vec3 p = local;
  for (int i = 0; i < SAMPLES; ++i) {
    p += step_local;
    float density = textureLod(density_map, p, 0.0).r;
#ifdef TRANSFER
    sum += textureLod(transfer_map, vec2(density, 0.5), 0.0);
#else
    sum += density;
#endif
#ifdef LIGHT_SPACE
    sum += textureLod(scattering_map, p, 0.0).r;
#endif
  }
#if SHADOW_FETCHES > 0
  vec3 q = vec3(local.xy, 0.0);
  for (int i = 0; i < SHADOW_FETCHES; ++i) {
    q.xy += step_local.xy;
    sum.rg += textureLod(shadow_moments, q, 0.0).rg;
  }
#endif
  mean = sum / float(SAMPLES + 1);
}
