// A photon's share for a texel of the light map.
flat in vec3 power;
flat in vec2 center;
flat in float area;

uniform float sigma;

layout(location = 0) out vec4 light;  // irradiance [W/m²]; a: power in the texel, the mean of the channels [W]

void main() {
  vec2 off = gl_FragCoord.xy - center;
  vec3 share = power * exp(-0.5 * dot(off, off) / (sigma * sigma));
  light = vec4(share / area, (share.r + share.g + share.b) / 3.0);
}
