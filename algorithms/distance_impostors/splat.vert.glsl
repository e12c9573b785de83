// One photon (Sec. 5). The part of its Gaussian that falls off the light map's border is given to the rest, so that its power stays.
layout(binding = 9) uniform sampler2DArray photon_places;
layout(binding = 10) uniform sampler2DArray photon_powers;
uniform int map_size;
uniform int light_map_size;
uniform float sigma;

out Photon {
  vec3 power;
  vec2 center;  // in texels
  ivec4 texels;  // first and last, x and y
  float norm;
  float area;  // of a texel [m²]
  int receiver;
} photon;

float weight_sum(float center, int first, int last) {
  float sum = 0.0;
  for (int i = first; i <= last; ++i) {
    float off = float(i) + 0.5 - center;
    sum += exp(-0.5 * off * off / (sigma * sigma));
  }
  return sum;
}

void main() {
  ivec3 at = ivec3(gl_VertexID % map_size, gl_VertexID / map_size, gl_InstanceID);
  vec4 place = texelFetch(photon_places, at, 0);
  photon.power = texelFetch(photon_powers, at, 0).rgb;
  photon.receiver = place.z >= 0.0 && place.w > 0.0 && photon.power != vec3(0.0) ? int(place.z) : -1;
  float size = float(light_map_size);
  photon.center = clamp(place.xy, 0.0, 1.0) * size;
  int reach = int(ceil(3.0 * sigma));
  ivec2 middle = ivec2(min(photon.center, vec2(size - 1.0)));
  ivec2 first = max(middle - reach, ivec2(0)), last = min(middle + reach, ivec2(light_map_size - 1));
  photon.texels = ivec4(first, last);
  photon.norm = 1.0 / (weight_sum(photon.center.x, first.x, last.x) * weight_sum(photon.center.y, first.y, last.y));
  photon.area = place.w / (size * size);
  gl_Position = vec4(0.0);
}
