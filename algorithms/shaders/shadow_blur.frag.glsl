// One direction of a separable Gaussian over the moments of one layer.
layout(binding = 0) uniform sampler2DArray source;
uniform int layer;
uniform ivec2 direction;
uniform float sigma;

layout(location = 0) out vec2 moments;

void main() {
  ivec2 last = textureSize(source, 0).xy - 1;
  ivec2 at = ivec2(gl_FragCoord.xy);
  int radius = int(ceil(3.0 * sigma));
  vec2 sum = vec2(0.0);
  float weights = 0.0;
  for (int i = -radius; i <= radius; ++i) {
    float weight = exp(-0.5 * float(i * i) / (sigma * sigma));
    sum += weight * texelFetch(source, ivec3(clamp(at + i * direction, ivec2(0), last), layer), 0).rg;
    weights += weight;
  }
  moments = sum / weights;
}
