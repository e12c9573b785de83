// Linear look-ups at full float precision. Texture units may weigh neighbours with as few as 8 bits, which shows as an
// error of up to 1/512 of the step between two entries of a LUT.
vec4 lut_texture(sampler1D lut, float at) {
  int last = textureSize(lut, 0) - 1;
  float x = clamp(at * float(last + 1) - 0.5, 0.0, float(last));
  int i = int(x);
  return mix(texelFetch(lut, i, 0), texelFetch(lut, min(i + 1, last), 0), x - float(i));
}

vec4 lut_texture(sampler2D lut, vec2 at) {
  ivec2 last = textureSize(lut, 0) - 1;
  vec2 x = clamp(at * vec2(last + 1) - 0.5, vec2(0.0), vec2(last));
  ivec2 i = ivec2(x), j = min(i + 1, last);
  vec2 f = x - vec2(i);
  vec4 low = mix(texelFetch(lut, i, 0), texelFetch(lut, ivec2(j.x, i.y), 0), f.x);
  vec4 high = mix(texelFetch(lut, ivec2(i.x, j.y), 0), texelFetch(lut, j, 0), f.x);
  return mix(low, high, f.y);
}

vec4 lut_texture(sampler3D lut, vec3 at) {
  ivec3 last = textureSize(lut, 0) - 1;
  vec3 x = clamp(at * vec3(last + 1) - 0.5, vec3(0.0), vec3(last));
  ivec3 i = ivec3(x), j = min(i + 1, last);
  vec3 f = x - vec3(i);
  vec4 c00 = mix(texelFetch(lut, i, 0), texelFetch(lut, ivec3(j.x, i.y, i.z), 0), f.x);
  vec4 c10 = mix(texelFetch(lut, ivec3(i.x, j.y, i.z), 0), texelFetch(lut, ivec3(j.x, j.y, i.z), 0), f.x);
  vec4 c01 = mix(texelFetch(lut, ivec3(i.x, i.y, j.z), 0), texelFetch(lut, ivec3(j.x, i.y, j.z), 0), f.x);
  vec4 c11 = mix(texelFetch(lut, ivec3(i.x, j.y, j.z), 0), texelFetch(lut, j, 0), f.x);
  return mix(mix(c00, c10, f.y), mix(c01, c11, f.y), f.z);
}
