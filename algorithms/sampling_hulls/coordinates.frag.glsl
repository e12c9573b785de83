// First step of 2 + 2M: opaque objects, their volume local coordinates as colours (Sec. 4, Fig. 6a).
in vec3 world_position;

uniform mat4 world_to_local;

layout(location = 0) out vec4 coordinates;

void main() { coordinates = vec4((world_to_local * vec4(world_position, 1.0)).xyz, 1.0); }
