// Work that no compiler can leave out.
uniform int iterations;
in vec2 uv;
layout(location = 0) out float color;

void main() {
  float x = uv.x + 0.5;
  for (int i = 0; i < iterations; ++i)
    x = fract(sin(x * 12.9898 + uv.y) * 43.7585) + 0.5;
  color = x;
}
