// A scattering medium blurs the environment behind it: Chan and Wang 2005, Sec. 3.3. Who includes it gives the unblurred
// light as `vec3 sharp_radiance(vec3 direction)`. Compiled with the defines of Translucency (raster/translucency.hpp), which
// binds what it reads.
#include "algorithms/shaders/cube_point.glsl"

layout(binding = 11) uniform sampler2D key_maps;      // as KeyAtlas lays them out (key_maps/key_atlas.hpp)
layout(binding = 12) uniform sampler2D transfer_map;  // by thickness; a row for each channel, and three more
uniform vec3 extinction;     // 1/m; scattering and absorption
uniform int key_map_size;
uniform int key_face_rows;
uniform float key_scale;
uniform vec3 mean_radiance;  // C_A

// Shares of the light that come through a thickness, and that it reflects; each number by channel.
struct Transfer {
  vec3 level, f_t;    // of the Gaussian: where in the chain, and its share
  vec3 level_2, f_2;  // of the second one
  vec3 sharp;         // the share that is kept apart and sharp
  vec3 c_t, c_r;
};

Transfer transfer_at(vec3 depth) {
  const float kEntries = 128.0, kHalfDepth = 2.0;  // as TransferTable has them
  vec3 x = ((kEntries - 1.0) * depth / (depth + kHalfDepth) + 0.5) / kEntries;
  vec4 one[3], two[3];
#ifdef COLOURED_MEDIUM
  const int kChannels = 3;
#else
  const int kChannels = 1;
#endif
  for (int c = 0; c < 3; ++c) {
    one[c] = c < kChannels ? textureLod(transfer_map, vec2(x[c], (float(c) + 0.5) / 6.0), 0.0) : one[0];
#ifdef TWO_GAUSSIANS
    two[c] = c < kChannels ? textureLod(transfer_map, vec2(x[c], (float(c) + 3.5) / 6.0), 0.0) : two[0];
#else
    two[c] = vec4(0.0);
#endif
  }
  Transfer t;
  t.level = vec3(one[0].x, one[1].x, one[2].x);
  t.f_t = vec3(one[0].y, one[1].y, one[2].y);
  t.c_t = vec3(one[0].z, one[1].z, one[2].z);
  t.c_r = vec3(one[0].w, one[1].w, one[2].w);
  t.level_2 = vec3(two[0].x, two[1].x, two[2].x);
  t.f_2 = vec3(two[0].y, two[1].y, two[2].y);
#ifdef UNSCATTERED_APART
  t.sharp = exp(-depth);
#else
  t.sharp = vec3(0.0);
#endif
  return t;
}

// Level `level` of the chain, from 1 on, where `place` is the corner of the face and where on it, from 0 to 1, a direction
// meets the cube. Beyond the last level it is any finite value.
vec3 key_map(vec4 place, int level) {
  int size = 2 * key_map_size >> level, above = key_map_size - 2 * size + 2 * (level - 2);
  vec2 corner = level == 1 ? vec2(0.0) : vec2(float(key_map_size + 2), float(above));
  return textureLod(key_maps, (corner + place.xy + float(size) * place.zw) / vec2(textureSize(key_maps, 0)), 0.0).rgb;
}

// C_B of each channel: the environment blurred as far as the channel's level says, without the part that level 0 makes up,
// which is the environment itself.
vec3 blurred(vec3 direction, vec3 level) {
  vec3 met = cube_point(direction);
  vec4 place = vec4(1.0, met.z * float(key_face_rows) + 1.0, 0.5 * met.xy + 0.5);
#ifdef COLOURED_MEDIUM
  // The channels lie near each other in the chain: each map between them is fetched once for all.
  int first = max(int(min(level.x, min(level.y, level.z))), 1);
  float last = max(level.x, max(level.y, level.z));
  vec3 sum = vec3(0.0);
  for (int l = first; float(l) < last + 1.0; ++l) sum += max(1.0 - abs(level - float(l)), 0.0) * key_map(place, l);
#else
  int first = max(int(level.x), 1);
  vec3 sum = max(1.0 - abs(level - float(first)), 0.0) * key_map(place, first) +
             max(1.0 - abs(level - float(first + 1)), 0.0) * key_map(place, first + 1);
#endif
  return key_scale * sum;
}

// The part of a blurred environment that level 0, the sharp one, makes up.
vec3 of_sharp(vec3 level) { return max(1.0 - level, 0.0); }

// Shares of the light that get through the thickness that translucent() was last asked about: all, and what has scattered.
vec3 transmitted_share = vec3(1.0), scattered = vec3(0.0);

// The light along a ray that went through an optical thickness, by channel, and of which `share` leaves in `direction`; and
// what the medium reflects over the last stretch, where `reflected` is what it had reflected before.
vec3 translucent(vec3 depth, vec3 direction, float share, inout vec3 reflected) {
#ifndef COLOURED_MEDIUM
  depth = depth.xxx;
#endif
  Transfer t = transfer_at(depth);
  vec3 sharp = t.sharp + t.f_t * of_sharp(t.level) + t.f_2 * of_sharp(t.level_2);
  vec3 light = (share * t.c_t + t.c_r - reflected) * mean_radiance + share * t.f_t * blurred(direction, t.level);
#ifdef TWO_GAUSSIANS
  light += share * t.f_2 * blurred(direction, t.level_2);
#endif
  light += share * sharp * sharp_radiance(direction);
  reflected = t.c_r;
  transmitted_share = t.f_t + t.c_t + t.f_2 + t.sharp;
  scattered = max(transmitted_share - exp(-depth), 0.0);
  return light;
}
