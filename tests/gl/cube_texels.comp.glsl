layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Directions { vec4 directions[]; };
layout(std430, binding = 1) writeonly buffer Texels { float texels[]; };
layout(binding = 0) uniform samplerCube numbered;

void main() {
  uint i = gl_GlobalInvocationID.x;
  texels[i] = textureLod(numbered, directions[i].xyz, 0.0).r;
}
