// Front faces of a hull into the back buffer: N points on the valid path, blended once (Sec. 3.2 and Fig. 7).
#include "algorithms/shaders/common/integrate.glsl"

in vec3 local;

layout(binding = 1) uniform sampler2D coordinates_map;
uniform mat4 world_to_local;
uniform vec3 eye;
uniform float sample_offset;

layout(location = 0) out vec4 color_and_transmittance;

void main() {
  // s(R) from the local-coordinates map: the hull's back face or an opaque object, whichever is nearer; s^F(R) here.
  vec3 s = texelFetch(coordinates_map, ivec2(gl_FragCoord.xy), 0).xyz;
  vec3 s_world = (volume_to_world * vec4(s, 1.0)).xyz;
  vec3 sf_world = (volume_to_world * vec4(local, 1.0)).xyz;
  vec3 ray = normalize(sf_world - eye);
  float path_length = valid_path_length(s_world, sf_world, ray);
  vec3 ray_local = mat3(world_to_local) * ray;
  color_and_transmittance = integrate_path(local, ray_local, path_length, SAMPLES, sample_offset);
}
