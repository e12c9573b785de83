// FETCHES texture fetches and as little else as the compiler lets through.
layout(binding = 0) uniform sampler2D source;
layout(location = 0) out vec4 color;

void main() {
  const vec2 texel = 1.0 / vec2(textureSize(source, 0));
  // A third of a texel off the centres, so that linear filtering has four to mix; neighbours read neighbours.
  const vec2 at = (gl_FragCoord.xy + vec2(0.33)) * texel;
  vec4 sum = vec4(0.0);
  for (int i = 0; i < FETCHES; ++i)
    sum += texture(source, at + float(i) * vec2(texel.x, 3.0 * texel.y));
  color = sum / float(FETCHES);
}
