// A grid over the medium's surface, each point moved to where the light that it refracts meets the plane at the solid's mean
// height.
#include "algorithms/translucent_relief/light_reaching.glsl"

uniform float plane_height;  // the solid's mean
uniform vec3 to_light;  // in the mesh's frame
uniform vec2 metres;    // over a unit of the mesh's u and v
uniform int grid;       // cells along a side of the maps
uniform bool copies;    // the maps repeat: a copy for each neighbour that light may come from

out vec2 source;  // of the maps
out vec3 share;   // of the light on a level plane, that comes through a level square metre

void main() {
  int cell = gl_VertexID / 6, corner = gl_VertexID % 6;
  vec2 at = vec2(cell % grid, cell / grid) + vec2(corner == 1 || corner == 3 || corner == 4 ? 1.0 : 0.0,
                                                  corner == 2 || corner == 4 || corner == 5 ? 1.0 : 0.0);
  source = at / float(grid);
  vec2 uv = source / tiling;
  float height = medium_height(source);
  share = vec3(0.0);
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // off the map
  if (height <= solid_height(source)) return;
  vec3 n = medium_normal(source, 1.0 / metres);
  float cosine = dot(to_light, n), eta = outside_index / index;
  if (cosine <= 0.0) return;
  float reflected_share = fresnel_dielectric(cosine, eta);
  if (reflected_share >= 1.0) return;
  Ray ray = Ray(vec3(0.0, 0.0, height), refract(-to_light, n, eta), uv, 1.0 / metres);
  // To a plane, where triangles of the grid stay whole; the solid's own shadows are the picture's.
  float t = max((plane_height - height) / ray.direction.z, 0.0);
  share = (1.0 - reflected_share) * cosine / (n.z * to_light.z) * transmitted(absorption, t);
  vec2 copy = copies ? vec2(gl_InstanceID % 3 - 1, gl_InstanceID / 3 - 1) : vec2(0.0);
  gl_Position = vec4(2.0 * (uv_at(ray, t) * tiling + copy) - 1.0, 0.0, 1.0);
}
