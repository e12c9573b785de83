// Scene-linear colour through OpenColorIO's generated function, whose text gl/display/display_gpu.cpp appends to this file.
layout(binding = 0) uniform sampler2D source;
uniform float gain;

in vec2 uv;
layout(location = 0) out vec4 color;

vec4 ocio_display(vec4 scene_linear);

void main() {
  color = vec4(ocio_display(vec4(gain * texture(source, uv).rgb, 1.0)).rgb, 1.0);
}

#include "gl/display/lut_sampling.glsl"
