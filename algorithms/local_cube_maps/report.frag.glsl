// The native errors compare this with the reference: the ray that leaves the object, and where it is taken to hit. In a
// dielectric this is the ray that leaves first.
#include "algorithms/local_cube_maps/lookup.glsl"
#include "algorithms/local_cube_maps/surface_point.glsl"
#if KIND == 3
#include "algorithms/local_cube_maps/refraction.glsl"
#endif

layout(location = 0) out vec4 ray_origin;     // a: 1 where the object is seen
layout(location = 1) out vec4 ray_direction;  // a: distance that the impostor stores at the hit [m]
layout(location = 2) out vec4 ray_hit;        // in the world; a: 0 where the ray leaves along a total reflection

void main() {
  vec3 V = normalize(world_position - eye);
  bool inside;
  vec3 n = visible_normal(V, inside);
  vec3 from = world_position;
  vec3 R;
  bool whole = true;
#if KIND == 3
  InnerPath path;
  path.position = world_position;
  path.throughput = vec3(1.0);
  path.direction = inside ? V : refract(V, n, 1.0 / ior);
  if (!inside && path.direction == vec3(0.0)) {
    R = reflect(V, n);
  } else {
    vec3 outward = inside ? -n : n, exit_weight;
#ifdef REFRACTOR
    if (!inside) go_on(path, outward);
    leave(path, outward, false, R, exit_weight);
    whole = any(greaterThan(exit_weight, vec3(0.0)));
#else
    if (inside) leave(path, outward, false, R, exit_weight);
    else R = path.direction;
#endif
    from = path.position;
  }
#else
  R = reflect(V, n);
#endif
  vec3 hit = environment_hit(from - reference_point, R);
  ray_origin = vec4(from, 1.0);
  ray_direction = vec4(R, textureLod(distance_cube, hit, 0.0).a);
  ray_hit = vec4(hit + reference_point, whole ? 1.0 : 0.0);
}
