// The light beyond what the display shows, from a block of pixels (Timonen, Sec. 4): separated with a square root, so that
// the sun does not drown the picture.
layout(binding = 0) uniform sampler2D picture;
uniform int block;  // pixels along a side
uniform float threshold;

layout(location = 0) out vec4 bright;

void main() {
  ivec2 first = block * ivec2(gl_FragCoord.xy), last = textureSize(picture, 0) - 1;
  vec3 sum = vec3(0.0);
  for (int y = 0; y < block; ++y) {
    for (int x = 0; x < block; ++x) {
      vec3 color = texelFetch(picture, min(first + ivec2(x, y), last), 0).rgb;
      float most = max(color.r, max(color.g, color.b));
      if (most > threshold) sum += color / most * sqrt(most - threshold);
    }
  }
  bright = vec4(sum / float(block * block), 1.0);
}
