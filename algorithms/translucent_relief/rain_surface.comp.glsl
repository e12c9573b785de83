// The surface of drops over a solid. C++ twin: rain_surface() (algorithms/scene/relief/rain.cpp).
layout(local_size_x = 8, local_size_y = 8) in;

struct Drop {
  int x, y, radius, life;
};
layout(std430, binding = 0) readonly buffer Drops { Drop drops[]; };
layout(binding = 0) uniform sampler2D ground;  // metres
layout(r32f, binding = 0) writeonly uniform image2D heights;
uniform int count;
uniform int largest;
uniform float below_m;
uniform float top_m;
uniform float height_m;

const float kUnits = 4096.0;

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy), size = imageSize(heights);
  if (any(greaterThanEqual(texel, size))) return;
  vec2 place = (vec2(texel) + 0.5) * kUnits / vec2(size);
  float surface = below_m;
  for (int i = 0; i < count; ++i) {
    Drop drop = drops[i];
    vec2 away = place - vec2(drop.x, drop.y);
    away -= kUnits * round(away / kUnits);
    float r = length(away) / float(drop.radius);
    if (r > 1.3) continue;
    float base = texelFetch(ground, ivec2(drop.x * size.x / 4096, drop.y * size.y / 4096), 0).r;
    surface = max(surface, base + height_m * (float(drop.radius) / float(largest)) * (1.0 - r * r));
  }
  imageStore(heights, texel, vec4(clamp((surface - below_m) / (top_m - below_m), 0.0, 1.0)));
}
