// A ray inside a dielectric (Sec. 4). REFRACTOR: there is a refractor map, and a ray refracts again where it leaves.
#include "algorithms/shaders/optics.glsl"

uniform float ior;
uniform vec3 absorption;

#ifdef REFRACTOR
layout(binding = 6) uniform samplerCube refractor_map;  // xyz: outward normal, a: distance from the object's centre
uniform mat4 world_to_map;                              // the mesh's own space, the centre at its origin
uniform mat4 map_to_world;

// The next interface on the way, and the outward normal there. The map is kept in the mesh's space, so that it holds
// however the object is placed; a straight ray stays straight in it.
vec3 inner_hit(vec3 position, vec3 R, out vec3 outward) {
  vec3 l = find_hit((world_to_map * vec4(position, 1.0)).xyz, normalize(mat3(world_to_map) * R), refractor_map);
  vec3 n = textureLod(refractor_map, l, 0.0).xyz;
  if (dot(n, n) < 0.1) n = l;  // a hole of the mesh
  outward = normalize(transpose(mat3(world_to_map)) * n);
  return (map_to_world * vec4(l, 1.0)).xyz;
}
#endif

// A path inside the object that has reached an interface. Light that leaves there goes on as `exit_direction` with the weight
// `exit_weight`; the rest is reflected and stays in the path. At the last interface nothing may stay: all that is left
// leaves, and where it is beyond the critical angle it leaves along the reflected ray.
struct InnerPath {
  vec3 position, direction, throughput;
#ifdef SCATTERING
  float way_m;  // so far; what absorbs is left to translucency.glsl
#endif
};
void leave(inout InnerPath path, vec3 outward, bool last, out vec3 exit_direction, out vec3 exit_weight) {
  float cosine = dot(path.direction, outward);
  if (cosine < 0.0) {  // the interpolated normal of a silhouette
    outward = -outward;
    cosine = -cosine;
  }
  float reflected = fresnel_dielectric(min(cosine, 1.0), ior);
  vec3 mirrored = path.direction - 2.0 * cosine * outward;
  exit_direction = reflected < 1.0 ? refract(path.direction, -outward, ior) : mirrored;
  exit_weight = path.throughput * (last ? 1.0 : 1.0 - reflected);
  path.throughput *= last ? 0.0 : reflected;
  path.direction = mirrored;
}

#ifdef REFRACTOR
void go_on(inout InnerPath path, out vec3 outward) {
  vec3 at = inner_hit(path.position, path.direction, outward);
#ifdef SCATTERING
  path.way_m += distance(at, path.position);
#else
  path.throughput *= transmitted(absorption, distance(at, path.position));
#endif
  path.position = at;
}
#endif
