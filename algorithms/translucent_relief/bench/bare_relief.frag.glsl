// As many fetches of the same textures as the technique makes at this pixel, in its order, and sums: the bare shader of
// `pellucid bench translucent_relief`. Each kind of ray has loops of its own, since a processor that runs pixels in step
// repeats a loop until the last of them is done.
#ifdef ENVIRONMENT_IMAGE
layout(binding = 0) uniform sampler2D environment_map;
#endif

in vec2 mesh_uv;

layout(binding = 3) uniform sampler2D solid_heights;
layout(binding = 4) uniform sampler2D medium_heights;
layout(binding = 5) uniform sampler2D solid_normals;
layout(binding = 6) uniform sampler2D medium_normals;
layout(binding = 7) uniform sampler2D solid_colors;
layout(binding = 12) uniform sampler2D solid_counts;  // as layers.glsl counts
layout(binding = 13) uniform sampler2D medium_counts;
layout(binding = 14) uniform sampler2D other_counts;
uniform vec2 tiling;

layout(location = 0) out vec4 radiance;

// A few texels on at each step, as the rays go.
vec2 at, by;
float sum = 0.0;

void fetch_solid(float count) {
  for (float k = 0.0; k < count; k += 1.0) {
    sum += textureLod(solid_heights, at, 0.0).r;
    at += by;
  }
}
void fetch_medium(float count) {
  for (float k = 0.0; k < count; k += 1.0) {
    sum += textureLod(medium_heights, at, 0.0).r;
    at += by;
  }
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 solid = texelFetch(solid_counts, pixel, 0), medium = texelFetch(medium_counts, pixel, 0);
  vec4 other = texelFetch(other_counts, pixel, 0);
  at = mesh_uv * tiling;
  by = vec2(0.7, -0.4) / vec2(textureSize(solid_heights, 0));
  float both = min(solid.x, medium.x);  // view rays look for the nearer of both
  for (float k = 0.0; k < both; k += 1.0) {
    sum += max(textureLod(solid_heights, at, 0.0).r, textureLod(medium_heights, at, 0.0).r);
    at += by;
  }
  fetch_solid(solid.x - both);
  fetch_medium(medium.x - both);
  if (other.x + other.z + other.w < 0.5) discard;  // it met nothing
  fetch_solid(solid.z);
  fetch_medium(medium.z);
  fetch_solid(solid.y);
  fetch_medium(medium.y);
  fetch_solid(solid.w);
  fetch_medium(medium.w);
  vec3 seen = vec3(sum);
  for (float k = 0.0; k < other.x; k += 1.0)
    seen += textureLod(solid_normals, at, 0.0).rgb + textureLod(solid_colors, at, 0.0).rgb;
  for (float k = 0.0; k < other.z; k += 1.0) seen += textureLod(medium_normals, at, 0.0).rgb;
#ifdef ENVIRONMENT_IMAGE
  for (float k = 0.0; k < other.w; k += 1.0) seen += textureLod(environment_map, at + 0.25 * k, 0.0).rgb;
#endif
  radiance = vec4(seen, 1.0);
  gl_FragDepth = gl_FragCoord.z;
}
