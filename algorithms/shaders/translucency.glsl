// A scattering medium blurs the environment behind it: Chan and Wang 2005, Sec. 3.3. Who includes it gives the unblurred
// light as `vec3 sharp_radiance(vec3 direction)`. Compiled with the defines of Translucency (raster/translucency.hpp), which
// binds what it reads.
layout(binding = 11) uniform samplerCube key_maps;   // mip level l is level l + 1 of the chain: level 0 is the environment itself
layout(binding = 12) uniform sampler2D transfer_map;  // by thickness; a row for each channel, and three more
uniform vec3 extinction;     // 1/m; scattering and absorption
uniform float key_scale;
uniform vec3 mean_radiance;  // C_A
uniform int transfer_model;  // 0 gaussian, 1 unscattered, 2 two_gaussians

// C_B: the environment blurred as far as the level says, of which level 0 is the sharp one.
vec3 blurred(vec3 direction, float level, vec3 sharp) {
  vec3 key = key_scale * textureLod(key_maps, direction, max(level - 1.0, 0.0)).rgb;
  return level < 1.0 ? mix(sharp, key, level) : key;
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

// Whether what comes through a thickness has a sharp part.
bool needs_sharp(vec4 one, vec4 two) {
  return one.x < 1.0 || two.z > 0.0 || (transfer_model == 2 && two.x < 1.0);
}

// The light that comes through a thickness from a direction outside.
vec3 through(vec4 one, vec4 two, vec3 direction, vec3 sharp) {
  vec3 light = one.y * blurred(direction, one.x, sharp) + one.z * mean_radiance + two.z * sharp;
  if (transfer_model == 2 && two.y > 0.0) light += two.y * blurred(direction, two.x, sharp);
  return light;
}

// Shares of the light that get through the thickness that translucent() was last asked about: all, and what has scattered.
vec3 transmitted_share = vec3(1.0), scattered = vec3(0.0);

// The light along a ray that went through an optical thickness, by channel, and of which `share` leaves in `direction`; and
// what the medium reflects over the last stretch, where `reflected` is what it had reflected before.
vec3 translucent(vec3 depth, vec3 direction, float share, inout vec3 reflected) {
#ifdef COLOURED_MEDIUM
  const int kChannels = 3;
#else
  const int kChannels = 1;  // stands for all
#endif
  vec4 one[kChannels], two[kChannels];
  bool sharpened = false;
  for (int c = 0; c < kChannels; ++c) {
    transfer_at(depth[c], float(c), one[c], two[c]);
    sharpened = sharpened || needs_sharp(one[c], two[c]);
  }
  // Once for all channels: the environment at its own resolution is the dearest of the fetches.
  vec3 sharp = sharpened && share > 0.0 ? sharp_radiance(direction) : vec3(0.0);
  vec3 light = vec3(0.0);
  for (int c = 0; c < kChannels; ++c) {
    vec3 seen = share > 0.0 ? share * through(one[c], two[c], direction, sharp) : vec3(0.0);
    seen += (one[c].w - reflected[c]) * mean_radiance;
    float whole = one[c].y + one[c].z + two[c].y + two[c].z, rest = max(whole - exp(-depth[c]), 0.0);
    if (kChannels == 1) {
      light = seen;
      reflected = vec3(one[c].w);
      transmitted_share = vec3(whole);
      scattered = vec3(rest);
    } else {
      light[c] = seen[c];
      reflected[c] = one[c].w;
      transmitted_share[c] = whole;
      scattered[c] = rest;
    }
  }
  return light;
}
