// A scattering medium blurs the environment behind it: Chan and Wang 2005, Sec. 3.3. Who includes it gives the unblurred
// light as `vec3 sharp_radiance(vec3 direction)`. Compiled with the defines of Translucency (raster/translucency.hpp), which
// binds what it reads.
layout(binding = 11) uniform samplerCube key_maps;   // mip level l is level l + 1 of the chain: level 0 is the environment itself
layout(binding = 12) uniform sampler2D transfer_map;  // by thickness; a row for each channel, and three more
uniform vec3 extinction;     // 1/m; scattering and absorption
uniform float key_scale;
uniform vec3 mean_radiance;  // C_A
uniform int transfer_model;  // 0 gaussian, 1 unscattered, 2 two_gaussians

// C_B: the environment blurred as far as the level says.
vec3 blurred(vec3 direction, float level) {
  if (level >= 1.0) return key_scale * textureLod(key_maps, direction, level - 1.0).rgb;
  vec3 sharp = sharp_radiance(direction);
  return level > 0.0 ? mix(sharp, key_scale * textureLod(key_maps, direction, 0.0).rgb, level) : sharp;
}

// For one channel and thickness: level, f_t, c_t, c_r; and level_2, f_2, and the unscattered part if it is kept apart.
void transfer_at(float depth, float channel, out vec4 one, out vec4 two) {
  const float kEntries = 128.0, kHalfDepth = 2.0;  // as TransferTable has them
  float x = ((kEntries - 1.0) * depth / (depth + kHalfDepth) + 0.5) / kEntries;
  one = textureLod(transfer_map, vec2(x, (channel + 0.5) / 6.0), 0.0);
  two = vec4(0.0);
  if (transfer_model == 1) two.z = exp(-depth);
  if (transfer_model == 2) two = textureLod(transfer_map, vec2(x, (channel + 3.5) / 6.0), 0.0);
}

// The light that comes through a thickness from a direction outside.
vec3 through(vec4 one, vec4 two, vec3 direction) {
  vec3 light = one.y * blurred(direction, one.x) + one.z * mean_radiance;
  if (transfer_model == 1 && two.z > 0.0) light += two.z * sharp_radiance(direction);
  if (transfer_model == 2 && two.y > 0.0) light += two.y * blurred(direction, two.x);
  return light;
}

vec3 scattered = vec3(0.0);  // what gets through the thickness that translucent() was last asked about, having scattered

// The light along a ray that went through an optical thickness, by channel, and of which `share` leaves in `direction`; and
// what the medium reflects over the last stretch, where `reflected` is what it had reflected before.
vec3 translucent(vec3 depth, vec3 direction, float share, inout vec3 reflected) {
#ifdef COLOURED_MEDIUM
  vec3 light;
  for (int c = 0; c < 3; ++c) {
    vec4 one, two;
    transfer_at(depth[c], float(c), one, two);
    light[c] = (one.w - reflected[c]) * mean_radiance[c];
    if (share > 0.0) light[c] += share * through(one, two, direction)[c];
    reflected[c] = one.w;
    scattered[c] = max(one.y + one.z + two.y + two.z - exp(-depth[c]), 0.0);
  }
  return light;
#else
  vec4 one, two;
  transfer_at(depth.x, 0.0, one, two);
  vec3 light = (one.w - reflected.x) * mean_radiance;
  if (share > 0.0) light += share * through(one, two, direction);
  reflected = vec3(one.w);
  scattered = vec3(max(one.y + one.z + two.y + two.z - exp(-depth.x), 0.0));
  return light;
#endif
}
