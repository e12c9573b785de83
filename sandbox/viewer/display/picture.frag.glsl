// One or two pictures, side by side or one over the other, at the zoom of the window: through OpenColorIO's function, whose text
// gl/display puts behind this file, to the display. In one pass, since a rasteriser on the processor pays for each. PLAIN: picture
// A alone, without warnings or false colours.
layout(binding = 0) uniform sampler2D picture_a;
layout(binding = 1) uniform sampler2D picture_b;
layout(binding = 2) uniform sampler2D ramp;  // colours from black to pale yellow, display-encoded
uniform vec2 origin;                         // in picture A's pixels, of the region's top left corner
uniform float per_pixel;                     // picture pixels per pixel of the window
uniform ivec2 region;                        // pixels
uniform float exposure;                      // a factor
uniform vec3 ground;                         // display-encoded, where there is no picture
uniform int mode;                            // CompareMode (picture_view.hpp)
uniform float wipe;                          // share of the region's width that shows A
uniform float gain;                          // of a difference
uniform int channel;                         // -1: all; 0 to 3: that one alone, in grey
uniform bool warn;                           // mark not-a-numbers, infinities and negative values
uniform bool false_color;                    // luminance in colours, 2^-6 to 2^6 around the exposure
uniform bool encoded;                        // the picture holds display-encoded colours already

layout(location = 0) out vec4 color;

vec4 ocio_display(vec4 scene_linear);

vec3 displayed(vec3 scene_linear) {
  return ocio_display(vec4(exposure * scene_linear, 1.0)).rgb;
}

#ifdef PLAIN
void main() {
  // Rows of pictures are stored from the top.
  vec2 place = origin + vec2(gl_FragCoord.x, float(region.y) - gl_FragCoord.y) * per_pixel;
  ivec2 size = textureSize(picture_a, 0), texel = ivec2(floor(place));
  bool inside = all(greaterThanEqual(texel, ivec2(0))) && all(lessThan(texel, size));
  color = vec4(inside ? displayed(texelFetch(picture_a, clamp(texel, ivec2(0), size - 1), 0).rgb) : ground, 1.0);
}
#else
const int kA = 0, kB = 1, kSideBySide = 2, kWipe = 3, kDifference = 4;

// The texel that covers the place; a picture of another size is stretched to A's. Alpha -1: there is none.
vec4 texel(sampler2D picture, vec2 place) {
  ivec2 size = textureSize(picture_a, 0), own = textureSize(picture, 0);
  if (any(lessThan(place, vec2(0.0))) || any(greaterThanEqual(place, vec2(size)))) return vec4(0.0, 0.0, 0.0, -1.0);
  return texelFetch(picture, min(ivec2(floor(place / vec2(size) * vec2(own))), own - 1), 0);
}

// Alpha tells what a pixel holds: 1 a picture, 0 nothing.
vec4 shown(vec4 value) {
  if (value.a < 0.0) return vec4(0.0);
  return vec4(channel < 0 ? value.rgb : vec3(value[channel]), 1.0);
}

vec4 composed() {
  vec2 at = vec2(gl_FragCoord.x, float(region.y) - gl_FragCoord.y);
  if (mode == kSideBySide) {
    float half_width = floor(float(region.x) / 2.0);
    bool right = at.x >= half_width;
    vec2 place = origin + (at - vec2(right ? half_width : 0.0, 0.0)) * per_pixel;
    return abs(at.x - half_width) < 1.0 ? vec4(0.0) : shown(right ? texel(picture_b, place) : texel(picture_a, place));
  }
  vec2 place = origin + at * per_pixel;
  if (mode == kDifference) {
    vec4 a = texel(picture_a, place), b = texel(picture_b, place);
    return shown(a.a < 0.0 ? a : vec4(gain * abs(a - b).rgb, gain * abs(a.a - b.a)));
  }
  bool second = mode == kB || (mode == kWipe && at.x >= wipe * float(region.x));
  return shown(second ? texel(picture_b, place) : texel(picture_a, place));
}

void main() {
  vec4 value = composed();
  color = vec4(ground, 1.0);
  if (value.a == 0.0) return;
  if (encoded) {
    color.rgb = value.rgb;
  } else if (false_color) {
    float luminance = dot(value.rgb, vec3(0.2126, 0.7152, 0.0722)) * exposure;
    float share = luminance > 0.0 ? clamp((log2(luminance) + 6.0) / 12.0, 0.0, 1.0) : 0.0;
    color.rgb = texture(ramp, vec2(share, 0.5)).rgb;
  } else {
    color.rgb = displayed(value.rgb);
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
#endif

#include "gl/display/lut_sampling.glsl"
