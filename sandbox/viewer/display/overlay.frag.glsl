// This is drawn over the displayed picture: the ground where there is none, warnings, false colours, grid of pixels.
layout(binding = 0) uniform sampler2D composed;
layout(binding = 1) uniform sampler2D ramp;  // colours from black to pale yellow, display-encoded
uniform ivec2 corner;                        // of the region, in the window
uniform bool warn;                           // mark not-a-numbers, infinities and negative values
uniform bool false_color;                    // luminance in colours, 2^-6 to 2^6 around the exposure
uniform bool encoded;                        // the picture holds display-encoded colours already
uniform float exposure_ev;

layout(location = 0) out vec4 color;

void main() {
  vec4 value = texelFetch(composed, ivec2(gl_FragCoord.xy) - corner, 0);
  color = vec4(0.0);
  if (value.a == 0.0) {
    color = vec4(0.11, 0.115, 0.125, 1.0);
    return;
  }
  if (encoded) color = vec4(value.rgb, 1.0);
  if (false_color) {
    float luminance = dot(value.rgb, vec3(0.2126, 0.7152, 0.0722)) * exp2(exposure_ev);
    float share = luminance > 0.0 ? clamp((log2(luminance) + 6.0) / 12.0, 0.0, 1.0) : 0.0;
    color = vec4(texture(ramp, vec2(share, 0.5)).rgb, 1.0);
  }
  if (!warn) return;
  if (any(isnan(value.rgb))) {
    color = vec4(1.0, 0.0, 1.0, 1.0);
  } else if (any(isinf(value.rgb))) {
    color = vec4(0.0, 1.0, 1.0, 1.0);
  } else if (any(lessThan(value.rgb, vec3(0.0)))) {
    color = vec4(0.1, 0.3, 1.0, 1.0);
  }
}
