// The fetches that the technique makes at this pixel, of the same textures in the same order, and sums: the bare shader of
// `pellucid bench translucent_relief`. Searches follow each other as in relief.frag.glsl, each in a loop of its own: a
// processor that runs pixels in step repeats each search until the last of them is done.
#include "algorithms/translucent_relief/bench/recorded_searches.glsl"
#include "algorithms/translucent_relief/settings.glsl"
#ifdef ENVIRONMENT_IMAGE
layout(binding = 0) uniform sampler2D environment_map;
#endif

in vec2 mesh_uv;

layout(binding = 3) uniform sampler2D solid_heights;
layout(binding = 4) uniform sampler2D medium_heights;
layout(binding = 5) uniform sampler2D solid_normals;
layout(binding = 6) uniform sampler2D medium_normals;
layout(binding = 7) uniform sampler2D solid_colors;
layout(binding = 14) uniform sampler2DArray records;  // groups of four words

layout(location = 0) out vec4 radiance;

const int kView = 0, kReflected = 1, kRefracted = 2, kLight = 3;

vec3 sum = vec3(0.0);
vec2 at;  // of the next height

uvec4 group_of(int word) {
  return floatBitsToUint(texelFetch(records, ivec3(gl_FragCoord.xy, word / 4), 0));
}

// Fetches where the search did: `FETCH` adds a height at `at`. Halvings follow equal steps in a loop of their own, as in
// linear_crossing().
#define MAKE_SEARCH(name, FETCH)                          \
  bool name(uint search, int kind) {                      \
    vec2 by = step_of(search);                            \
    uint count = search & kHeights;                       \
    bool met = (search & kMet) != 0u;                     \
    uint halvings = min(met ? kHalvings : 0u, count);     \
    count -= halvings;                                    \
    if (count > 0u) {                                     \
      do {                                                \
        FETCH;                                            \
        at += by;                                         \
      } while (--count > 0u);                             \
    }                                                     \
    if (halvings > 0u) {                                  \
      do {                                                \
        FETCH;                                            \
        at += by;                                         \
      } while (--halvings > 0u);                          \
    }                                                     \
    return met;                                           \
  }
#if SEARCH == 0
#define kHalvings uint(refinements[kind])
#else
#define kHalvings 0u
#endif
MAKE_SEARCH(search_solid, sum.x += textureLod(solid_heights, at, 0.0).r)
MAKE_SEARCH(search_medium, sum.x += textureLod(medium_heights, at, 0.0).r)
MAKE_SEARCH(search_both, sum.x += max(textureLod(solid_heights, at, 0.0).r, textureLod(medium_heights, at, 0.0).r))

void follow_lights(vec2 place, int turn) {
#if LIGHT_COUNT > 0 && defined(OCCLUSION)
  int light = 0;
  do {
    int word = light_search(turn, light, boundaries), last = word + boundaries;
    uvec4 group = group_of(word);
    at = place;
    search_solid(group.x, kLight);
#ifdef TWO_LAYERS
    at = place;
    bool met;
    do {
      group = (++word & 3) == 0 ? group_of(word) : group.yzwx;
      met = search_medium(group.x, kLight);
      if (met) sum += textureLod(medium_normals, at, 0.0).rgb;
    } while (met && word < last);
#endif
  } while (++light < LIGHT_COUNT);
#endif
}

void main() {
  uvec4 view = group_of(0);
  uint fragment = view.x;
  at = mesh_uv * tiling;
#if MAPPING != 0
#ifdef TWO_LAYERS
#if defined(SEPARATE_BOXES) || SEARCH != 0
  search_medium(view.y, kView);
  at = mesh_uv * tiling;
  search_solid(view.z, kView);
#else
  search_both(view.y, kView);
  sum.x += textureLod(solid_heights, at, 0.0).r + textureLod(medium_heights, at, 0.0).r;  // which of them was met
#endif
#else
  search_solid(view.y, kView);
#endif
  if ((fragment & kSeen) == 0u) discard;
#endif
  vec2 hit = at, behind = at, reflected = at;
#ifdef TWO_LAYERS
  if ((fragment & kOnMedium) != 0u) {
    sum += textureLod(medium_normals, hit, 0.0).rgb;
    uvec4 group = group_of(part_search(0));
    int part = (fragment & kOnlyReflected) != 0u ? 1 : 0;
    do {
      at = hit;
      bool solid = search_solid(part == 0 ? group.x : group.z, part == 0 ? kRefracted : kReflected);
      if (part == 0) behind = at;
      else reflected = at;
#ifdef ENVIRONMENT_IMAGE
      if (!solid) sum += textureLod(environment_map, at, 0.0).rgb;
#endif
    } while (++part < 2);
#ifdef ABSORPTION
    at = hit;
    search_medium(group.y, kRefracted);
#endif
  }
#endif
  int turn = 0;
  uint kind = place_of(fragment, turn);
  if (kind != 0u) {
    do {
      vec2 place = kind == kSurfacePlace ? hit : kind == kThroughPlace ? behind : reflected;
      if (kind != kSurfacePlace) {
        sum += textureLod(solid_normals, place, 0.0).rgb + textureLod(solid_colors, place, 0.0).rgb;
#ifdef TWO_LAYERS
        sum.x += textureLod(medium_heights, place, 0.0).r;
#endif
      }
      follow_lights(place, turn);
      kind = ++turn < kMostTurns ? place_of(fragment, turn) : 0u;
    } while (kind != 0u);
  }
  radiance = vec4(sum, 1.0);
  gl_FragDepth = gl_FragCoord.z;
}
