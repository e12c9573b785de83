// Writes every uniform back, in the order of its declaration.
layout(local_size_x = 1) in;
layout(std430, binding = 0) buffer Results {
  float results[];
};

uniform bool a_bool;
uniform int an_int;
uniform float a_float;
uniform vec2 a_vec2;
uniform vec3 a_vec3;
uniform vec4 a_vec4;
uniform ivec2 an_ivec2;
uniform ivec3 an_ivec3;
uniform mat3 a_mat3;
uniform mat4 a_mat4;

void main() {
  results[0] = a_bool ? 1.0 : 0.0;
  results[1] = float(an_int);
  results[2] = a_float;
  for (int i = 0; i < 2; ++i)
    results[3 + i] = a_vec2[i];
  for (int i = 0; i < 3; ++i)
    results[5 + i] = a_vec3[i];
  for (int i = 0; i < 4; ++i)
    results[8 + i] = a_vec4[i];
  for (int i = 0; i < 2; ++i)
    results[12 + i] = float(an_ivec2[i]);
  for (int i = 0; i < 3; ++i)
    results[14 + i] = float(an_ivec3[i]);
  results[17] = a_mat3[2][0];
  results[18] = a_mat4[3][1];
}
