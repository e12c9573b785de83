// Heights of a surface of waves. C++ twin: make_pattern() (algorithms/scene/relief/patterns.cpp).
layout(local_size_x = 8, local_size_y = 8) in;

layout(r32f, binding = 0) writeonly uniform image2D heights;
struct Sine {
  float cycles_u, cycles_v, amplitude, phase, speed;
};
layout(std430, binding = 0) readonly buffer Sines { Sine sines[]; };
uniform float time_s;

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy), size = imageSize(heights);
  if (any(greaterThanEqual(texel, size))) return;
  const float kTurn = 6.28318530717959;
  vec2 uv = (vec2(texel) + 0.5) / vec2(size);
  float sum = 0.5;
  for (int i = 0; i < sines.length(); ++i) {
    Sine s = sines[i];
    // Whole turns are taken off the time's part first, where they would cost digits.
    float turned = fract(s.speed * time_s / kTurn);
    sum += s.amplitude * cos(kTurn * (fract(dot(vec2(s.cycles_u, s.cycles_v), uv)) - turned) + s.phase);
  }
  imageStore(heights, texel, vec4(clamp(sum, 0.0, 1.0)));
}
