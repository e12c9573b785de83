// Slopes of a height map over u and v by central differences. C++ twin: slopes_of() (algorithms/scene/relief/patterns.cpp).
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D heights;
layout(rg32f, binding = 0) writeonly uniform image2D slopes;

float height(ivec2 texel, ivec2 size) { return texelFetch(heights, (texel + size) % size, 0).r; }

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy), size = imageSize(slopes);
  if (any(greaterThanEqual(texel, size))) return;
  vec2 rise = vec2(height(texel + ivec2(1, 0), size) - height(texel - ivec2(1, 0), size),
                   height(texel + ivec2(0, 1), size) - height(texel - ivec2(0, 1), size));
  imageStore(slopes, texel, vec4(0.5 * vec2(size) * rise, 0.0, 0.0));
}
