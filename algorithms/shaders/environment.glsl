// Radiance from everywhere. C++ twin: Environment::radiance (algorithms/scene/scene.cpp).
#ifdef ENVIRONMENT_IMAGE
layout(binding = 0) uniform sampler2D environment_map;  // lat-long, row 0 of the image at +y
#endif
// A shader that has these otherwise says so.
#ifndef HAS_SKY
uniform float radiance_scale;
uniform vec3 zenith;
uniform vec3 horizon;
uniform vec3 ground;
#endif

vec3 environment_radiance(vec3 direction) {
  float y = clamp(direction.y, -1.0, 1.0);
#ifdef ENVIRONMENT_IMAGE
  const float kInvPi = 0.318309886183791;
  float u = 0.5 + atan(direction.x, -direction.z) * (0.5 * kInvPi);
  // u wraps; v ends at the poles' texel centres.
  float half_texel = 0.5 / float(textureSize(environment_map, 0).y);
  float v = clamp(acos(y) * kInvPi, half_texel, 1.0 - half_texel);
  return radiance_scale * textureLod(environment_map, vec2(u, 1.0 - v), 0.0).rgb;
#else
  return radiance_scale * mix(horizon, y >= 0.0 ? zenith : ground, abs(y));
#endif
}
