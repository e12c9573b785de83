// One or two pictures, side by side or one over the other, at the zoom of the window: scene-linear, for the display
// transform. Alpha tells what a pixel holds: 1 a picture, 0 nothing.
layout(binding = 0) uniform sampler2D picture_a;
layout(binding = 1) uniform sampler2D picture_b;
uniform vec2 origin;      // in picture A's pixels, of the region's top left corner
uniform float per_pixel;  // picture pixels per pixel of the window
uniform ivec2 region;     // pixels
uniform int mode;         // CompareMode (picture_view.hpp)
uniform float wipe;       // share of the region's width that shows A
uniform float gain;       // of a difference
uniform int channel;      // -1: all; 0 to 3: that one alone, in grey

layout(location = 0) out vec4 color;

const int kA = 0, kB = 1, kSideBySide = 2, kWipe = 3, kDifference = 4;

// The texel that covers the place; a picture of another size is stretched to A's.
vec4 texel(sampler2D picture, vec2 place) {
  ivec2 size = textureSize(picture_a, 0), own = textureSize(picture, 0);
  if (any(lessThan(place, vec2(0.0))) || any(greaterThanEqual(place, vec2(size)))) return vec4(0.0, 0.0, 0.0, -1.0);
  return texelFetch(picture, min(ivec2(floor(place / vec2(size) * vec2(own))), own - 1), 0);
}

vec4 shown(vec4 value) {
  if (value.a < 0.0) return vec4(0.0);
  return vec4(channel < 0 ? value.rgb : vec3(value[channel]), 1.0);
}

void main() {
  // Rows of pictures are stored from the top.
  vec2 at = vec2(gl_FragCoord.x, float(region.y) - gl_FragCoord.y);
  if (mode == kSideBySide) {
    float half_width = floor(float(region.x) / 2.0);
    bool right = at.x >= half_width;
    vec2 place = origin + (at - vec2(right ? half_width : 0.0, 0.0)) * per_pixel;
    color = abs(at.x - half_width) < 1.0 ? vec4(0.0) : shown(right ? texel(picture_b, place) : texel(picture_a, place));
    return;
  }
  vec2 place = origin + at * per_pixel;
  if (mode == kDifference) {
    vec4 a = texel(picture_a, place), b = texel(picture_b, place);
    color = shown(a.a < 0.0 ? a : vec4(gain * abs(a - b).rgb, gain * abs(a.a - b.a)));
    return;
  }
  bool second = mode == kB || (mode == kWipe && at.x >= wipe * float(region.x));
  color = shown(second ? texel(picture_b, place) : texel(picture_a, place));
}
