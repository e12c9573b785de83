// The blurred light, to be added to the picture.
layout(binding = 0) uniform sampler2D blurred;
uniform vec2 pixels;  // of the picture
uniform float strength;

layout(location = 0) out vec4 added;

void main() { added = vec4(strength * textureLod(blurred, gl_FragCoord.xy / pixels, 0.0).rgb, 0.0); }
