layout(location = 0) in vec3 corner;
layout(location = 1) in float column;
layout(location = 2) in float instance_value;
flat out float value;

void main() {
  value = instance_value;
  gl_Position = vec4(0.5 * (corner.x + column) - 1.0, 2.0 * corner.y - 1.0, 0.0, 1.0);
}
