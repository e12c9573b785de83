// As many fetches of the same textures as the geocube's search makes at this pixel, and sums: the bare shader of `pellucid
// bench geocube`.
#include "algorithms/geocube/cube_maps.glsl"
#include "algorithms/geocube/entry.glsl"
#ifdef ENVIRONMENT_IMAGE
layout(binding = 0) uniform sampler2D environment_map;
#endif

layout(binding = 5) uniform sampler2D entries;
layout(binding = 7) uniform sampler2D fetch_counts;  // as glass.frag.glsl counts
uniform int object_number;
uniform vec3 eye;
uniform mat3 pixel_to_ray;

layout(location = 0) out vec4 radiance;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 entering = texelFetch(entries, pixel, 0);
  bool here = tagged_object(entering.w) == object_number;
  if (!here) discard;
  vec3 count = here ? texelFetch(fetch_counts, pixel, 0).xyz : vec3(0.0);
  int cube = tagged_cube(entering.w);
  // Across the object and back to the other side, as the rays do.
  vec3 from = eye + entering.x * (pixel_to_ray * vec3(gl_FragCoord.xy, 1.0)) - cube_spheres[cube].xyz;
  vec3 by = -2.0 * from / max(count.x + count.y, 1.0);
  vec4 sum = vec4(0.0);
  for (float k = 0.0; k < count.x; k += 1.0) {
    CubeSample s = fetch_cube(cube, from);
    sum += s.bounds + s.plane;
    from += by;
  }
  for (float k = 0.0; k < count.y; k += 1.0) {
    sum += fetch_bounds(cube, from);
    from += by;
  }
#ifdef ENVIRONMENT_IMAGE
  for (float k = 0.0; k < count.z; k += 1.0)
    sum += textureLod(environment_map, 0.5 * entering.yz + 0.5 + 0.25 * k, 0.0);
#endif
  radiance = vec4(sum.rgb, 1.0);
}
