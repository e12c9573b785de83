// Back faces of a hull into the local-coordinates map (Sec. 4, Fig. 6c).
in vec3 local;

layout(location = 0) out vec4 coordinates;

void main() { coordinates = vec4(local, 1.0); }
