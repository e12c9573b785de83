// hit_search.glsl in rooms whose distance has a closed form. ROOM: 0 a box about (0.3, -0.2, 0.1), 1 a ball.
layout(local_size_x = 64) in;
struct Ray {
  vec4 x, direction;
};
layout(std430, binding = 0) readonly buffer Rays { Ray rays[]; };
layout(std430, binding = 1) writeonly buffer Hits { vec4 hits[]; };

float room_distance(vec3 direction) {
#if ROOM == 0
  vec3 d = direction / length(direction);
  vec3 away = (vec3(0.3, -0.2, 0.1) + sign(d) * vec3(2.0, 1.5, 2.5)) / d;
  return min(away.x, min(away.y, away.z));
#else
  return 1.7;
#endif
}
#define IMPOSTOR_MAP int
#define IMPOSTOR_DISTANCE(map, direction) room_distance(direction)
#include "algorithms/local_cube_maps/hit_search.glsl"

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < uint(rays.length())) hits[i] = vec4(find_hit(rays[i].x.xyz, rays[i].direction.xyz, 0), 1.0);
}
