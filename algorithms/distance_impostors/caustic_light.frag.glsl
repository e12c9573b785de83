// The light map's addition to a receiver's radiance. In the stead of a normal comes the place, see caustics.cpp.
in vec3 world_normal;
in vec3 albedo;

layout(binding = 7) uniform sampler2DArray light_maps;

layout(location = 0) out vec4 radiance;
layout(location = 1) out vec4 nothing;  // a cube's distance stays

void main() {
  vec3 irradiance = textureLod(light_maps, vec3(world_normal.xy, floor(world_normal.z + 0.0005)), 0.0).rgb;
  radiance = vec4(albedo * irradiance / 3.14159265358979, 0.0);
  nothing = vec4(0.0);
}
