// As many fetches of a height map as the technique makes of its maps at this pixel, and sums: the bare shader of `pellucid
// bench translucent_relief`.
#ifdef ENVIRONMENT_IMAGE
layout(binding = 0) uniform sampler2D environment_map;
#endif

in vec2 mesh_uv;

layout(binding = 3) uniform sampler2D solid_heights;
layout(binding = 14) uniform sampler2D fetch_counts;  // of maps; of the environment; 1
uniform vec2 tiling;

layout(location = 0) out vec4 radiance;

void main() {
  vec4 count = texelFetch(fetch_counts, ivec2(gl_FragCoord.xy), 0);
  if (count.z < 0.5) discard;
  // A few texels on at each step, as the rays go.
  vec2 uv = mesh_uv * tiling, by = vec2(0.7, -0.4) / vec2(textureSize(solid_heights, 0));
  float sum = 0.0;
  for (float k = 0.0; k < count.x; k += 1.0) {
    sum += textureLod(solid_heights, uv, 0.0).r;
    uv += by;
  }
  vec3 seen = vec3(sum);
#ifdef ENVIRONMENT_IMAGE
  for (float k = 0.0; k < count.y; k += 1.0) seen += textureLod(environment_map, uv + 0.25 * k, 0.0).rgb;
#endif
  radiance = vec4(seen, 1.0);
  gl_FragDepth = gl_FragCoord.z;
}
