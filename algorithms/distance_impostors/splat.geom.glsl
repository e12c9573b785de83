// A photon's texels as a quadrilateral in the light map of its receiver.
layout(points) in;
layout(triangle_strip, max_vertices = 4) out;

uniform int light_map_size;

in Photon {
  vec3 power;
  vec2 center;
  ivec4 texels;
  float norm;
  float area;
  int receiver;
} photons[];

flat out vec3 power;  // over the sum of the weights [W]
flat out vec2 center;
flat out float area;

void main() {
  if (photons[0].receiver < 0) return;
  for (int i = 0; i < 4; ++i) {
    vec2 corner = vec2((i & 1) == 0 ? photons[0].texels.x : photons[0].texels.z + 1,
                       (i & 2) == 0 ? photons[0].texels.y : photons[0].texels.w + 1);
    power = photons[0].power * photons[0].norm;
    center = photons[0].center;
    area = photons[0].area;
    gl_Layer = photons[0].receiver;
    gl_Position = vec4(corner / float(light_map_size) * 2.0 - 1.0, 0.0, 1.0);
    EmitVertex();
  }
  EndPrimitive();
}
