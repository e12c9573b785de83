// Front faces of a hull into the back buffer: N points on the valid path, blended once (Sec. 3.2 and Fig. 7).
#include "algorithms/shaders/medium.glsl"
#include "algorithms/shaders/integrate.glsl"

layout(binding = 1) uniform sampler2D coordinates_map;
flat in float sample_offset;

layout(location = 0) out vec4 color_and_transmittance;

void main() {
  // s(R) from the local-coordinates map: the hull's back face or an opaque object, whichever is nearer; s^F(R) here.
  vec3 s = texelFetch(coordinates_map, ivec2(gl_FragCoord.xy), 0).xyz;
  float begin_m = length(from_eye);
  float path_length = valid_path_length(s, local, metres / begin_m);
  color_and_transmittance = integrate_path(medium_path(local, begin_m), path_length, SAMPLES, sample_offset);
}
