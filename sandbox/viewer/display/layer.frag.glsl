// The panel, drawn with premultiplied alpha into a texture of its own, over the window.
layout(binding = 0) uniform sampler2D layer;
layout(location = 0) out vec4 color;

void main() {
  color = texelFetch(layer, ivec2(gl_FragCoord.xy), 0);
}
