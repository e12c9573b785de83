// Searches over a field in a texture: by equal steps, through a pyramid, through cones.
#include "algorithms/translucent_relief/search.glsl"
#include "algorithms/translucent_relief/cone_step.glsl"
#include "algorithms/translucent_relief/max_mip.glsl"

layout(local_size_x = 64) in;

struct Input {
  vec4 origin;     // w: the range's begin
  vec4 direction;  // w: its end
  vec2 uv;
  float side;
  float steps;
  float refinements;
  float pad[3];
};
struct Output {
  float linear, taken, max_mip, cone, relaxed;
};
layout(std430, binding = 0) readonly buffer Inputs { Input inputs[]; };
layout(std430, binding = 1) writeonly buffer Outputs { Output outputs[]; };
layout(binding = 3) uniform sampler2D heights;
layout(binding = 4) uniform sampler2D pyramid;
layout(binding = 5) uniform sampler2D cones;

const float kLow = -0.3, kRange = 0.3;

vec2 units_of(int layer) { return vec2(kLow, kRange); }
float height_at(int layer, vec2 at) { return textureLod(heights, at, 0.0).r; }
vec2 extremes(int layer, ivec2 cell, int level) {
  ivec2 size = max(textureSize(heights, 0) >> level, ivec2(1));
  return kLow + kRange * texelFetch(pyramid, cell & (size - 1), level).rg;
}
vec4 corners(int layer, ivec2 cell) {
  return kLow + kRange * textureGather(heights, vec2(cell + 1) / vec2(textureSize(heights, 0))).wzxy;
}
ivec2 map_size(int layer) { return textureSize(heights, 0); }
int pyramid_top(int layer) { return findMSB(textureSize(heights, 0).x); }
const int kEmpty = 0, kRelaxed = 1;
float cone_at(int layer, vec2 at, bool falls) { return textureLod(cones, at, 0.0)[layer == kRelaxed && falls ? 1 : 0]; }

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= inputs.length()) return;
  Input q = inputs[i];
  Ray ray = Ray(q.origin.xyz, q.direction.xyz, q.uv, vec2(1.0));
  vec2 range = vec2(q.origin.w, q.direction.w);
  float taken = 0.0, unused = 0.0;
  float linear = linear_crossing(0, ray, vec2(1.0), range, q.side, 1e-6, int(q.steps), int(q.refinements), taken);
  float max_mip = max_mip_crossing(0, ray, vec2(1.0), range, q.side, 4096, unused);
  float cone = cone_crossing(kEmpty, ray, vec2(1.0), kRange, range, 1e-6, 256, 8, unused);
  float relaxed = cone_crossing(kRelaxed, ray, vec2(1.0), kRange, range, 1e-6, 256, 12, unused);
  outputs[i] = Output(linear, taken, max_mip, cone, relaxed);
}
