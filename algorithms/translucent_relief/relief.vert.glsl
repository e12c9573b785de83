// A mesh that carries a relief.
#define UNIFORM_SETTINGS
#include "algorithms/translucent_relief/settings.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 color;
layout(location = 3) in vec2 uv;
layout(location = 4) in vec3 over_u;
layout(location = 5) in vec3 over_v;

uniform mat4 to_world;
uniform mat3 normal_to_world;
uniform mat4 world_to_clip;

out vec3 world_position;
out vec3 world_normal;
out vec3 world_over_u;  // metres over a unit of u
out vec3 world_over_v;
out vec3 tint;
out vec2 mesh_uv;
out Settings { RELIEF_SETTINGS(flat) } handed_on;

void main() {
  vec4 world = to_world * vec4(position, 1.0);
  world_position = world.xyz;
  world_normal = normal_to_world * normal;
  world_over_u = mat3(to_world) * over_u;
  world_over_v = mat3(to_world) * over_v;
  tint = color;
  mesh_uv = uv;
  gl_Position = world_to_clip * world;
  handed_on.solid_range = solid_range;
  handed_on.medium_range = medium_range;
  handed_on.tiling = tiling;
  handed_on.index_ratios = index_ratios;
  handed_on.absorption = absorption;
  handed_on.step_counts = step_counts;
  handed_on.refinements = refinements;
  handed_on.steps_at_normal = steps_at_normal;
  handed_on.boundaries = boundaries;
  handed_on.solid_albedo = solid_albedo;
  handed_on.solid_phong = solid_phong;
  handed_on.medium_phong = medium_phong;
  handed_on.intensification = intensification;
  handed_on.plane_height = plane_height;
  handed_on.least_shine = least_shine;
  handed_on.cut = cut;
  handed_on.solid_normal_map = solid_normal_map;
  handed_on.medium_normal_map = medium_normal_map;
  handed_on.eye = eye;
  handed_on.radiance_scale = radiance_scale;
  handed_on.zenith = zenith;
  handed_on.horizon = horizon;
  handed_on.ground = ground;
}
