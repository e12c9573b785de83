// Light in a medium that scatters, by the transfer functions of a slab (Chan and Wang 2005, Sec. 3.3), which transfer.cpp
// makes.
layout(binding = 15) uniform sampler2D transfer_table;  // rows: sharp, f_t, θ̄, c_t of a channel each; c_r of all
uniform vec3 extinction;                                // [1/m]

vec4 transfer_row(float depth, int row) {
  // Entry i stands for the depth 2 x / (1 − x), x = i / (n − 1).
  int last = textureSize(transfer_table, 0).x - 1;
  float at = depth / (depth + 2.0) * float(last);
  int i = min(int(at), last - 1);
  return mix(texelFetch(transfer_table, ivec2(i, row), 0), texelFetch(transfer_table, ivec2(i + 1, row), 0), at - float(i));
}

// The light that gets through, scattered or not.
vec3 scattered_transmittance(float path) {
  vec3 share;
  for (int c = 0; c < 3; ++c) {
    vec4 fit = transfer_row(extinction[c] * path, c);
    share[c] = fit.x + fit.y + fit.w;
  }
  return share;
}

// The share of arriving light that comes back.
vec3 scattered_reflectance(float path) {
  return vec3(transfer_row(extinction.r * path, 3).r, transfer_row(extinction.g * path, 3).g,
              transfer_row(extinction.b * path, 3).b);
}
