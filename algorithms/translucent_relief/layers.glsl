// The two layers' maps. Heights are metres along the mesh's normal, 0 at the mesh.
#include "algorithms/translucent_relief/search.glsl"
#include "algorithms/translucent_relief/settings.glsl"
#include "algorithms/translucent_relief/cone_step.glsl"
#include "algorithms/translucent_relief/max_mip.glsl"

layout(binding = 3) uniform sampler2D solid_heights;
layout(binding = 5) uniform sampler2D solid_normals;
layout(binding = 7) uniform sampler2D solid_colors;
#ifdef TWO_LAYERS
layout(binding = 4) uniform sampler2D medium_heights;
layout(binding = 6) uniform sampler2D medium_normals;
#endif
// The search reads these: greatest and least heights by level, or cones.
layout(binding = 8) uniform sampler2D solid_acceleration;
layout(binding = 9) uniform sampler2D medium_acceleration;

const int kSolid = 0, kMedium = 1, kEither = 2;
const int kView = 0, kReflected = 1, kRefracted = 2, kLight = 3;

#ifdef COUNT
#include "algorithms/translucent_relief/bench/recorded_searches.glsl"
layout(binding = 0, r32ui) uniform writeonly uimage2DArray records;  // a word in a layer
float fetches = 0.0;                                                 // of all maps
uint heights = 0u;                                                   // and in one search
int next_search = kViewSearch;
int turn = 0;
uint fragment = 0u;
void record(int word, uint value) { imageStore(records, ivec3(gl_FragCoord.xy, word), uvec4(value)); }
void record_search(bool met, vec2 at, vec2 end) {
  record(next_search++, search_word(heights, met, (end - at) / float(max(heights, 1u))));
  heights = 0u;
}
#define RECORDED(what) what
#define FETCHED(n) fetches += float(n)
#define FETCHED_HEIGHT() fetches += 1.0, ++heights
#else
#define RECORDED(what)
#define FETCHED(n)
#define FETCHED_HEIGHT()
#endif

// At a place of the maps.
float solid_texel(vec2 at) {
  FETCHED_HEIGHT();
  return textureLod(solid_heights, at, 0.0).r;
}
float medium_texel(vec2 at) {
#ifdef TWO_LAYERS
  FETCHED_HEIGHT();
  return textureLod(medium_heights, at, 0.0).r;
#else
  return 0.0;
#endif
}
float solid_height(vec2 at) { return solid_range.x + solid_range.y * solid_texel(at); }
float medium_height(vec2 at) {
#ifdef TWO_LAYERS
  return medium_range.x + medium_range.y * medium_texel(at);
#else
  return -1e9;
#endif
}

// Both together are given in metres, so that the greater may be taken.
vec2 units_of(int layer) {
#ifdef TWO_LAYERS
  if (layer == kMedium) return medium_range;
#endif
  return layer == kSolid ? solid_range : vec2(0.0, 1.0);
}
float height_at(int layer, vec2 at) {
  if (layer == kSolid) return solid_texel(at);
  if (layer == kMedium) return medium_texel(at);
  return max(solid_height(at), medium_height(at));
}

vec2 extremes(int layer, ivec2 cell, int level) {
#ifdef TWO_LAYERS
  if (layer == kMedium) {
    FETCHED_HEIGHT();
    ivec2 size = max(textureSize(medium_heights, 0) >> level, ivec2(1));
    return medium_range.x + medium_range.y * texelFetch(medium_acceleration, cell & (size - 1), level).rg;
  }
#endif
  FETCHED_HEIGHT();
  ivec2 size = max(textureSize(solid_heights, 0) >> level, ivec2(1));
  return solid_range.x + solid_range.y * texelFetch(solid_acceleration, cell & (size - 1), level).rg;
}
ivec2 map_size(int layer) {
#ifdef TWO_LAYERS
  if (layer == kMedium) return textureSize(medium_heights, 0);
#endif
  return textureSize(solid_heights, 0);
}
int pyramid_top(int layer) {
  ivec2 size = map_size(layer);
  return findMSB(max(size.x, size.y));
}
vec4 corners(int layer, ivec2 cell) {
  vec2 middle = vec2(cell + 1) / vec2(map_size(layer));
#ifdef TWO_LAYERS
  if (layer == kMedium) {
    FETCHED_HEIGHT();
    return medium_range.x + medium_range.y * textureGather(medium_heights, middle).wzxy;
  }
#endif
  FETCHED_HEIGHT();
  return solid_range.x + solid_range.y * textureGather(solid_heights, middle).wzxy;
}
float cone_at(int layer, vec2 at, bool falls) {
#if SEARCH == 3
  int which = falls ? 1 : 0;
#else
  const int which = 0;
#endif
#ifdef TWO_LAYERS
  if (layer == kMedium) {
    FETCHED_HEIGHT();
    return textureLod(medium_acceleration, at, 0.0)[which];
  }
#endif
  FETCHED_HEIGHT();
  return textureLod(solid_acceleration, at, 0.0)[which];
}
float range_of(int layer) {
#ifdef TWO_LAYERS
  if (layer == kMedium) return medium_range.y;
#endif
  return solid_range.y;
}

// A little more than the heights take, so that the lowest and the highest of them are found.
vec2 bounds_of(int layer) {
  vec2 solid = vec2(solid_range.x, solid_range.x + solid_range.y);
  vec2 bounds = solid;
#ifdef TWO_LAYERS
  vec2 medium = vec2(medium_range.x, medium_range.x + medium_range.y);
  if (layer == kMedium) bounds = medium;
  else if (layer == kEither) bounds = vec2(min(solid.x, medium.x), max(solid.y, medium.y));
#endif
  return bounds + 1e-3 * (bounds.y - bounds.x) * vec2(-1.0, 1.0);
}

vec2 clip_to_layer(int layer, Ray ray, float from) {
  vec2 bounds = bounds_of(layer);
  return clip_ray(ray, bounds.x, bounds.y, cut != 0, from);
}

// Unit normal from a texel: of a normal map, or of the slopes of heights.
vec3 normal_of(vec4 texel, bool normal_map, float range, vec2 uv_per_metre) {
  return normalize(normal_map ? texel.xyz : vec3(-range * texel.xy * tiling * uv_per_metre, 1.0));
}
vec3 solid_normal(vec2 at, vec2 uv_per_metre) {
  FETCHED(1);
  return normal_of(textureLod(solid_normals, at, 0.0), solid_normal_map != 0, solid_range.y, uv_per_metre);
}
vec3 medium_normal(vec2 at, vec2 uv_per_metre) {
#ifdef TWO_LAYERS
  FETCHED(1);
  return normal_of(textureLod(medium_normals, at, 0.0), medium_normal_map != 0, medium_range.y, uv_per_metre);
#else
  return vec3(0.0, 0.0, 1.0);
#endif
}
