// Light that reaches a point past the opaque objects. C++ twin: algorithms/shadows.hpp.
#include "algorithms/shaders/common/lighting.glsl"

// Chebyshev's bound over the moments of the occluders' depth (Donnelly and Lauritzen 2006, Eq. 5).
float chebyshev_bound(vec2 moments, float depth, float min_variance) {
  if (depth <= moments.x) return 1.0;
  float variance = max(moments.y - moments.x * moments.x, min_variance);
  float behind = depth - moments.x;
  return variance / (variance + behind * behind);
}

float reduce_bleeding(float bound, float amount) { return clamp((bound - amount) / (1.0 - amount), 0.0, 1.0); }

// Imagire et al. 2007, Eq. 4.
vec4 filtered_occlusion(vec4 half_way_before, vec4 at_point, vec4 half_way_after) {
  return 0.25 * half_way_before + 0.5 * at_point + 0.25 * half_way_after;
}

#ifdef SHADOWS
const int kMaxShadowLayers = 24;

layout(std140, binding = 1) uniform Shadows {
  mat4 world_to_shadow[kMaxShadowLayers];  // clip space of each layer
  vec4 first_layer_range[kMaxLights];      // x: first layer, −1 without a shadow; y: 1 / depth range; z: depth of the origin
  vec4 bleeding_variance;                  // x: bleeding reduction, y: least variance
};
layout(binding = 2) uniform sampler2DArray shadow_moments;

// Which of a point light's six layers sees the direction.
int cube_layer(vec3 direction) {
  vec3 a = abs(direction);
  if (a.x >= a.y && a.x >= a.z) return direction.x > 0.0 ? 0 : 1;
  if (a.y >= a.z) return direction.y > 0.0 ? 2 : 3;
  return direction.z > 0.0 ? 4 : 5;
}

// Share of the i-th light that reaches `p`.
float light_visibility(int i, vec3 p) {
  vec2 layer_range = first_layer_range[i].xy;
  if (layer_range.x < 0.0) return 1.0;
  Light light = lights[i];
  int layer = int(layer_range.x);
  vec3 from_light = p - light.position_kind.xyz;
  float depth;
  if (light.position_kind.w < 0.5) {
    depth = dot(p, light.direction_outer.xyz) - first_layer_range[i].z;
  } else {
    depth = length(from_light);
    if (light.position_kind.w < 1.5) layer += cube_layer(from_light);
  }
  vec4 clip = world_to_shadow[layer] * vec4(p, 1.0);
  if (clip.w <= 0.0) return 1.0;  // behind a spot, where no light of it goes
  vec2 uv = clip.xy / clip.w * 0.5 + 0.5;
  if (any(lessThan(uv, vec2(0.0))) || any(greaterThan(uv, vec2(1.0)))) return 1.0;
  vec2 moments = textureLod(shadow_moments, vec3(uv, float(layer)), 0.0).rg;
  return reduce_bleeding(chebyshev_bound(moments, depth * layer_range.y, bleeding_variance.y), bleeding_variance.x);
}
#else
float light_visibility(int i, vec3 p) { return 1.0; }
#endif

// All lights at once.
vec4 light_visibilities(vec3 p) {
  vec4 visible = vec4(1.0);
  int count = int(ambient_count.w);
  for (int i = 0; i < count; ++i) visible[i] = light_visibility(i, p);
  return visible;
}
