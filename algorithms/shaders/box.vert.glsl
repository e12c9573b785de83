// Pieces of the volume's box; vertices are local coordinates.
layout(location = 0) in vec3 position;

uniform mat4 local_to_clip;

out vec3 local;

void main() {
  local = position;
  gl_Position = local_to_clip * vec4(position, 1.0);
}
