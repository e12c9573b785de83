// The two layers' maps. Heights are metres along the mesh's normal, 0 at the mesh.
#include "algorithms/translucent_relief/search.glsl"
#include "algorithms/translucent_relief/cone_step.glsl"
#include "algorithms/translucent_relief/max_mip.glsl"

layout(binding = 3) uniform sampler2D solid_heights;
layout(binding = 5) uniform sampler2D solid_normals;
layout(binding = 7) uniform sampler2D solid_colors;
uniform vec2 solid_range;  // the height of 0, and what is added at 1
uniform bool solid_normal_map;
#ifdef TWO_LAYERS
layout(binding = 4) uniform sampler2D medium_heights;
layout(binding = 6) uniform sampler2D medium_normals;
uniform vec2 medium_range;
uniform bool medium_normal_map;
#endif
// The search reads these: greatest and least heights by level, or cones.
layout(binding = 8) uniform sampler2D solid_acceleration;
layout(binding = 9) uniform sampler2D medium_acceleration;
uniform vec2 tiling;
uniform bool cut;

const int kSolid = 0, kMedium = 1, kEither = 2;
const int kView = 0, kReflected = 1, kRefracted = 2, kLight = 3;

#ifdef COUNT
// Fetches of the layers' heights and what speeds up their search, by the kind of ray; and of the solid's normals and colours,
// of the medium's normals, of the environment.
vec4 solid_fetches = vec4(0.0), medium_fetches = vec4(0.0), other_fetches = vec4(0.0);
int ray_kind = kView;
#define FETCHED(which, n) which += float(n)
#else
#define FETCHED(which, n)
#endif

// At a place of the maps.
float solid_height(vec2 at) {
  FETCHED(solid_fetches[ray_kind], 1);
  return solid_range.x + solid_range.y * textureLod(solid_heights, at, 0.0).r;
}
float medium_height(vec2 at) {
#ifdef TWO_LAYERS
  FETCHED(medium_fetches[ray_kind], 1);
  return medium_range.x + medium_range.y * textureLod(medium_heights, at, 0.0).r;
#else
  return -1e9;
#endif
}

float above(int layer, vec3 at) {
  if (layer == kSolid) return at.z - solid_height(at.xy);
  if (layer == kMedium) return at.z - medium_height(at.xy);
  return at.z - max(solid_height(at.xy), medium_height(at.xy));
}

vec2 extremes(int layer, ivec2 cell, int level) {
#ifdef TWO_LAYERS
  if (layer == kMedium) {
    FETCHED(medium_fetches[ray_kind], 1);
    ivec2 size = max(textureSize(medium_heights, 0) >> level, ivec2(1));
    return medium_range.x + medium_range.y * texelFetch(medium_acceleration, cell & (size - 1), level).rg;
  }
#endif
  FETCHED(solid_fetches[ray_kind], 1);
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
    FETCHED(medium_fetches[ray_kind], 1);
    return medium_range.x + medium_range.y * textureGather(medium_heights, middle).wzxy;
  }
#endif
  FETCHED(solid_fetches[ray_kind], 1);
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
    FETCHED(medium_fetches[ray_kind], 1);
    return textureLod(medium_acceleration, at, 0.0)[which];
  }
#endif
  FETCHED(solid_fetches[ray_kind], 1);
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
  return clip_ray(ray, bounds.x, bounds.y, cut, from);
}

// Unit normal from a texel: of a normal map, or of the slopes of heights.
vec3 normal_of(vec4 texel, bool normal_map, float range, vec2 uv_per_metre) {
  return normalize(normal_map ? texel.xyz : vec3(-range * texel.xy * tiling * uv_per_metre, 1.0));
}
vec3 solid_normal(vec2 at, vec2 uv_per_metre) {
  FETCHED(other_fetches.x, 1);
  return normal_of(textureLod(solid_normals, at, 0.0), solid_normal_map, solid_range.y, uv_per_metre);
}
vec3 medium_normal(vec2 at, vec2 uv_per_metre) {
#ifdef TWO_LAYERS
  FETCHED(other_fetches.z, 1);
  return normal_of(textureLod(medium_normals, at, 0.0), medium_normal_map, medium_range.y, uv_per_metre);
#else
  return vec3(0.0, 0.0, 1.0);
#endif
}
