// One slice: the density of its plane stands for its whole slab (Imagire et al. 2007, Sec. 2.1 and Fig. 2).
#include "algorithms/shaders/common/medium.glsl"

in vec3 local;

uniform vec3 eye;
uniform vec3 slab_axis;  // unit, across the slabs
uniform float slab_m;    // thickness along it

layout(location = 0) out vec4 color_and_transmittance;

void main() {
  vec3 ray = normalize((volume_to_world * vec4(local, 1.0)).xyz - eye);
  MediumPoint medium = medium_at(local);
  float opacity = step_opacity(medium.extinction, slab_m / abs(dot(ray, slab_axis)));
  color_and_transmittance = vec4(opacity * medium_source(local, medium.albedo, medium_visibility(local)), 1.0 - opacity);
}
