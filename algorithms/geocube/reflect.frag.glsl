// A mirror or a metal under the environment.
#include "algorithms/shaders/environment.glsl"
#include "algorithms/shaders/mirror.glsl"

in vec3 object_position;
in vec3 object_normal;

uniform vec3 eye;  // in the object's space
uniform mat3 object_to_world;

layout(location = 0) out vec4 radiance;

void main() {
  vec3 v = normalize(object_position - eye);
  vec3 n = normalize(object_normal);
  if (dot(v, n) > 0.0) n = -n;
  vec3 share = mirror_share(-dot(v, n));
  radiance = vec4(share * environment_radiance(normalize(object_to_world * reflect(v, n))), 1.0);
}
