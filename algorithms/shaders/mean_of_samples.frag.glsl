// A pixel of the supersampled frame: the mean of its samples.
layout(binding = 0) uniform sampler2D frame;
uniform int samples;  // along each side of a pixel

layout(location = 0) out vec4 pixel;

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * samples;
  vec4 sum = vec4(0.0);
  for (int y = 0; y < samples; ++y) {
    for (int x = 0; x < samples; ++x) sum += texelFetch(frame, first + ivec2(x, y), 0);
  }
  pixel = sum / float(samples * samples);
}
