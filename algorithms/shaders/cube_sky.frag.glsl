// The environment in a cube map of radiance and distance.
#include "algorithms/shaders/environment.glsl"

in vec3 world_position;

uniform vec3 eye;
uniform float sky_distance;  // [m]; finite, so that a filter between sky and object has a value

layout(location = 0) out vec4 radiance;
layout(location = 1) out vec4 eye_distance_m;

void main() {
  radiance = vec4(environment_radiance(normalize(world_position - eye)), 1.0);
#ifdef DISTANCE_IN_ALPHA
  radiance.a = sky_distance;
#endif
  eye_distance_m = vec4(sky_distance);
}
