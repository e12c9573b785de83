// A mirror or a metal under the environment.
#include "algorithms/shaders/environment.glsl"
#include "algorithms/shaders/mirror.glsl"

in vec3 world_position;
in vec3 world_normal;

uniform vec3 eye;

layout(location = 0) out vec4 radiance;

void main() {
  vec3 v = normalize(world_position - eye);
  vec3 n = normalize(world_normal);
  if (dot(v, n) > 0.0) n = -n;
  vec3 share = mirror_share(-dot(v, n));
  radiance = vec4(share * environment_radiance(reflect(v, n)), 1.0);
}
