// Fresnel's two shares of the environment at the first interface.
#include "algorithms/shaders/environment.glsl"
#include "algorithms/shaders/mirror.glsl"

in vec3 world_position;
in vec3 world_normal;

uniform vec3 eye;
uniform bool reflection;
uniform bool dielectric;
uniform float ior;

layout(location = 0) out vec4 radiance;

void main() {
  vec3 v = normalize(world_position - eye);
  vec3 n = normalize(world_normal);
  // Interpolated, a normal may look away at the silhouette: there the ray grazes.
  float cosine = max(-dot(v, n), 0.0);
  if (-dot(v, n) < 0.0) n = normalize(n - 1.0001 * dot(v, n) * v);
  vec3 mirrored = environment_radiance(reflect(v, n));
  if (!dielectric) {
    radiance = vec4(mirror_share(cosine) * mirrored, 1.0);
    return;
  }
  float share = fresnel_dielectric(cosine, 1.0 / ior);
  vec3 color = reflection ? share * mirrored : vec3(0.0);
  vec3 t = refract(v, n, 1.0 / ior);
  if (share < 1.0) color += (1.0 - share) * environment_radiance(t);
  radiance = vec4(color, 1.0);
}
