// A grid over the mesh's texture on the medium's surface, each node moved to where the light that it refracts meets the plane at
// the solid's mean height.
#define UNIFORM_SETTINGS
#include "algorithms/shaders/lighting.glsl"
#include "algorithms/translucent_relief/light_reaching.glsl"

layout(binding = 14) uniform sampler2DArray nodes;  // as CausticNode (caustic_charts.hpp), four layers for each of charts
uniform mat4 to_world;
uniform mat3 normal_to_world;
uniform int grid;            // cells along a side of the maps
uniform int light;
uniform int chart;
uniform bool copies;   // the maps repeat: a copy for each neighbour that light may come from
uniform ivec2 closes;  // 1: the chart closes on itself over u, over v; else it goes on as its edge's tangent plane

out vec2 source;  // of the mesh's texture
out vec3 power;   // of the light that comes through a unit of it

vec4 node_at(ivec2 node, int part) { return texelFetch(nodes, ivec3(node, 4 * chart + part), 0); }

// The node whose place, or whose tangent plane, a copy's node lies on.
ivec2 on_mesh(ivec2 node, ivec2 copy) {
  return ivec2(mix(vec2(clamp(node + grid * copy, ivec2(0), ivec2(grid))), vec2(node), vec2(closes)));
}

void main() {
  int cell = gl_VertexID / 6, corner = gl_VertexID % 6;
  ivec2 first = ivec2(cell % grid, cell / grid);
  ivec2 node = first + ivec2(corner == 1 || corner == 3 || corner == 4, corner == 2 || corner == 4 || corner == 5);
  ivec2 copy = copies ? ivec2(gl_InstanceID % 3 - 1, gl_InstanceID / 3 - 1) : ivec2(0);
  source = vec2(node) / float(grid);
  power = vec3(0.0);
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // off the map
  for (int i = 0; i < 4; ++i) {
    if (node_at(on_mesh(first + ivec2(i & 1, i >> 1), copy), 0).w == 0.0) return;  // beside the mesh
  }
  ivec2 at = on_mesh(node, copy);
  vec2 beyond = vec2(node + grid * copy * (1 - closes) - at) / float(grid);
  vec3 over_u = node_at(at, 2).xyz, over_v = node_at(at, 3).xyz;
  vec3 mesh_position = node_at(at, 0).xyz + beyond.x * over_u + beyond.y * over_v;
  vec3 position = (to_world * vec4(mesh_position, 1.0)).xyz;
  vec2 metres;
  mat3 to_frame = surface_frame(normalize(normal_to_world * node_at(at, 1).xyz), mat3(to_world) * over_u,
                                mat3(to_world) * over_v, metres);
  // Where the solid is bare, light comes to it as it is: a cell on the medium's edge takes part with both.
  float medium = medium_height(source * tiling), solid = solid_height(source * tiling);
  bool bare = medium <= solid;
  float height = bare ? solid : medium;
  vec3 to_light;
  vec3 irradiance = light_irradiance(light, position + vec3(0.0, 0.0, height) * to_frame, to_light);
  to_light = to_frame * to_light;
  if (to_light.z <= 0.0) return;
  vec3 n = bare ? vec3(0.0, 0.0, 1.0) : medium_normal(source * tiling, 1.0 / metres);
  float cosine = dot(to_light, n), eta = bare ? 1.0 : index_ratios.x;
  if (cosine <= 0.0) return;
  float reflected_share = bare ? 0.0 : fresnel_dielectric(cosine, eta);
  if (reflected_share >= 1.0) return;
  Ray ray = Ray(vec3(0.0, 0.0, height), refract(-to_light, n, eta), source, 1.0 / metres);
  // To a plane, where triangles of the grid stay whole; the solid's own shadows are the picture's.
  float t = max((plane_height - height) / ray.direction.z, 0.0);
  power = irradiance * ((1.0 - reflected_share) * cosine / n.z * metres.x * metres.y) *
          (bare ? vec3(1.0) : transmitted(absorption, t));
  gl_Position = vec4(2.0 * (uv_at(ray, t) + vec2(copy)) - 1.0, 0.0, 1.0);
}
