// Orange, or its complement, blended over the picture by the share s (Eq. 1).
uniform float strength;

layout(location = 0) out vec4 color;

void main() {
  vec3 tint = vec3(1.0, 0.5, 0.25);
#ifdef INVERTED
  tint = 1.0 - tint;
#endif
  color = vec4(tint, strength);
}
