// A dispatch of nothing: what it takes to start one.
layout(local_size_x = 64) in;
layout(std430, binding = 0) buffer Sink {
  uint sink[];
};
uniform int never;

void main() {
  if (never != 0) sink[gl_GlobalInvocationID.x] = 1u;
}
