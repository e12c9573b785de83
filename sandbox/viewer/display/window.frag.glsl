// The window: the picture as displayed, and the panel over it, which is drawn with premultiplied alpha into a texture of its own.
layout(binding = 0) uniform sampler2D picture;
layout(binding = 1) uniform sampler2D layer;
uniform ivec2 corner;  // of the picture, in the window
uniform bool any_picture;
uniform vec3 ground;

layout(location = 0) out vec4 color;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), in_picture = at - corner;
  ivec2 size = textureSize(picture, 0);
  bool inside = any_picture && all(greaterThanEqual(in_picture, ivec2(0))) && all(lessThan(in_picture, size));
  vec3 under = inside ? texelFetch(picture, clamp(in_picture, ivec2(0), size - 1), 0).rgb : ground;
  vec4 over = texelFetch(layer, at, 0);
  color = vec4(over.rgb + (1.0 - over.a) * under, 1.0);
}
