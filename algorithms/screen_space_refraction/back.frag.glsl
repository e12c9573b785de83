// The far side as the screen shows it: outward normal, and distance from the eye.
in vec3 world_position;
in vec3 world_normal;

uniform vec3 eye;

layout(location = 0) out vec4 normal_distance;

void main() { normal_distance = vec4(normalize(world_normal), length(world_position - eye)); }
