// One slice: the density of its plane stands for its whole slab (Imagire et al. 2007, Sec. 2.1 and Fig. 2).
#include "algorithms/shaders/medium.glsl"

uniform vec3 slab_axis;  // unit, across the slabs
uniform float slab_m;    // thickness along it

layout(location = 0) out vec4 color_and_transmittance;

void main() {
  float begin_m = length(from_eye);
  MediumPath path = medium_path(local, begin_m);
  MediumPoint medium = medium_at(local);
  float opacity = step_opacity(medium.extinction, slab_m * begin_m / abs(dot(from_eye, slab_axis)));
  color_and_transmittance =
      vec4(opacity * medium_source(path, 0.0, medium.albedo, medium_visibility(path, 0.0)), 1.0 - opacity);
}
