// Steps in cones and spheres: the appendix of Chan and Wang 2005. C++ twin: search.hpp.
const float kFar = 1e30;

#ifdef FUNCTION_TABLE
layout(binding = 3) uniform sampler2D function_table;  // C* over (mu, gamma), S* over (f, gamma); gamma in [-1, 1]
vec2 table_at(float first, float gamma) {
  vec2 size = vec2(textureSize(function_table, 0));
  vec2 uv = clamp(vec2(first, 0.5 * gamma + 0.5), 0.0, 1.0);
  return textureLod(function_table, (uv * (size - 1.0) + 0.5) / size, 0.0).xy;
}
float cone_wall(float mu, float gamma) { return table_at(mu, gamma).x; }
float sphere_step(float f, float gamma) { return table_at(f, gamma).y; }
#else
float cone_wall(float mu, float gamma) {
  float sine = sqrt(max(0.0, 1.0 - mu * mu));
  float below = gamma * sine + mu * sqrt(max(0.0, 1.0 - gamma * gamma));
  return below > 1e-9 ? sine / below : kFar;
}
float sphere_step(float f, float gamma) { return sqrt(max(0.0, 1.0 - f * f * (1.0 - gamma * gamma))) - f * gamma; }
#endif

float cone_step(float f, float h_a, float h_n, float a_n, float mu) {
  float wall = (1.0 - f) * cone_wall(mu, -h_a);
  if (h_n <= 0.0) return wall;
  float base = f * a_n / h_n;
  return h_a < mu ? min(wall, base) : base;
}
