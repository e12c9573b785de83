// One direction of a separable Gaussian.
layout(binding = 0) uniform sampler2D source;
uniform ivec2 direction;
uniform float sigma;  // texels

layout(location = 0) out vec4 blurred;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(source, 0) - 1;
  int reach = int(ceil(3.0 * sigma));
  vec4 sum = vec4(0.0);
  float weights = 0.0;
  for (int i = -reach; i <= reach; ++i) {
    float weight = exp(-0.5 * float(i * i) / (sigma * sigma));
    sum += weight * texelFetch(source, clamp(at + i * direction, ivec2(0), last), 0);
    weights += weight;
  }
  blurred = sum / weights;
}
