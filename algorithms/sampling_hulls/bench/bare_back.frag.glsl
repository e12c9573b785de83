// The bench's back faces of a hull: a constant into the map, so that only the write is paid for.
layout(location = 0) out vec4 coordinates;

void main() { coordinates = vec4(1.0); }
