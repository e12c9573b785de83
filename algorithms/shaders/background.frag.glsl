// The environment behind everything.
#include "algorithms/shaders/environment.glsl"

in vec2 clip_position;

uniform mat4 clip_to_world;
uniform vec3 eye;

layout(location = 0) out vec4 radiance;
layout(location = 1) out float eye_distance_m;

void main() {
  vec4 world = clip_to_world * vec4(clip_position, 1.0, 1.0);
  radiance = vec4(environment_radiance(normalize(world.xyz / world.w - eye)), 1.0);
  eye_distance_m = uintBitsToFloat(0x7f800000u);  // nothing is hit: infinity
}
