// Samples the volume at every point and stores the value in w.
layout(local_size_x = 1) in;
layout(binding = 0) uniform sampler3D volume;
layout(std430, binding = 0) buffer Points {
  vec4 points[];
};

void main() {
  uint i = gl_GlobalInvocationID.x;
  points[i].w = textureLod(volume, points[i].xyz, 0.0).r;
}
