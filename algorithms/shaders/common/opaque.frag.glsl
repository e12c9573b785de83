// The usual shading of opaque objects.
#include "algorithms/shaders/common/shadows.glsl"

in vec3 world_position;
in vec3 world_normal;
in vec3 albedo;
flat in vec3 emission;

uniform vec3 eye;

layout(location = 0) out vec4 radiance;
layout(location = 1) out float eye_distance_m;

void main() {
  vec3 n = normalize(world_normal);
  vec3 to_eye = eye - world_position;
  if (dot(n, to_eye) < 0.0) n = -n;
  radiance = vec4(surface_radiance(world_position, n, albedo, emission, light_visibilities(world_position)), 1.0);
  eye_distance_m = length(to_eye);
}
