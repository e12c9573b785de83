// Light that reaches a point past the opaque objects.
#include "algorithms/shaders/lighting.glsl"
#include "algorithms/shaders/occlusion.glsl"

#ifdef SHADOWS
const int kShadowLayers[kMaxLights] = int[](SHADOW_LAYERS);      // the first of each light, −1 without a shadow
const bool kLitBeyondMap[kMaxLights] = bool[](LIT_BEYOND_MAP);  // spots of a wider angle than a shadow map sees

struct Shadow {
  vec4 to_map[3];  // rows, to (u, v, depth) for directional lights; the first two to (u, v) times the distance along a spot's axis
  vec4 range;      // x: 1 / depth range [1/m]; y: from a point light's direction to texture coordinates of its layers
};
layout(std140, binding = 1) uniform Shadows {
  Shadow shadows[kMaxLights];
  vec4 bleeding_variance;  // xy: `cut` of reduce_bleeding(); z: least variance
};
layout(binding = 2) uniform sampler2DArray shadow_moments;

// Texture coordinates and layer of a direction in a point light's six layers; each looks along an axis, with y up, or x
// where it looks along y.
vec3 cube_coordinates(vec3 d, float scale) {
  vec3 a = abs(d);
  bool x = a.x >= a.y && a.x >= a.z, y = !x && a.y >= a.z;
  float along = x ? d.x : y ? d.y : d.z;
  float side = along > 0.0 ? 1.0 : -1.0;
  vec2 across = x ? vec2(side * d.z, d.y) : y ? vec2(-side * d.z, d.x) : vec2(-side * d.x, d.y);
  float layer = (x ? 0.0 : y ? 2.0 : 4.0) + (along > 0.0 ? 0.0 : 1.0);
  return vec3(across * (scale / max(abs(along), 1e-6)) + 0.5, layer);
}
#endif

bool casts_shadow(int i) {
#ifdef SHADOWS
  return kShadowLayers[i] >= 0;
#else
  return false;
#endif
}

// A point (w = 1) or a difference of points (w = 0) as the light sees it, affine in `p`. Directional: shadow map and depth
// in it. Spot: z is the distance along its axis, and xy / z lies in the shadow map. Point: from the light.
vec3 light_place(int i, vec4 p) {
  vec3 place = p.xyz - p.w * lights[i].position_kind.xyz;
  if (kLightKinds[i] == kPoint) return place;
  place.z = dot(place, lights[i].direction_outer.xyz);
#ifdef SHADOWS
  if (casts_shadow(i)) {
    place.xy = vec2(dot(shadows[i].to_map[0], p), dot(shadows[i].to_map[1], p));
    if (kLightKinds[i] == kDirectional) place.z = dot(shadows[i].to_map[2], p);
  }
#endif
  return place;
}

#ifdef SHADOWS
// Share of the i-th light, which casts a shadow, that reaches a place `distance` away. `range`: its Shadow::range;
// `settings`: bleeding_variance.
float shadow_share(int i, vec3 place, float distance, vec2 range, vec3 settings) {
  float depth = distance * range.x;
  vec3 at = vec3(0.0, 0.0, float(kShadowLayers[i]));
  if (kLightKinds[i] == kDirectional) {
    at.xy = place.xy;
    depth = place.z;
  } else if (kLightKinds[i] == kSpot) {
    at.xy = place.xy * (1.0 / max(place.z, 1e-6));  // what lies behind a spot has no light of it to lose
  } else {
    at += cube_coordinates(place, range.y);
  }
  vec2 moments = textureLod(shadow_moments, at, 0.0).rg;
  float share = reduce_bleeding(chebyshev_bound(moments, depth, settings.z), settings.xy);
  if (kLitBeyondMap[i] && (place.z <= 0.0 || any(greaterThan(abs(at.xy - 0.5), vec2(0.5))))) share = 1.0;
  return share;
}
#endif

// Share of the i-th light that reaches `p`.
float light_visibility(int i, vec3 p) {
#ifdef SHADOWS
  if (casts_shadow(i)) {
    return shadow_share(i, light_place(i, vec4(p, 1.0)), distance(p, lights[i].position_kind.xyz), shadows[i].range.xy,
                        bleeding_variance.xyz);
  }
#endif
  return 1.0;
}

// All lights at once.
vec4 light_visibilities(vec3 p) {
  vec4 visible = vec4(1.0);
  for (int i = 0; i < LIGHT_COUNT; ++i) visible[i] = light_visibility(i, p);
  return visible;
}
