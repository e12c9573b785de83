// Rays bent in air of varying index above the mesh (Timonen, Sec. 6). C++ twin, of higher order: algorithms/reference/
// relief_air.cpp.
layout(binding = 10) uniform sampler3D air_index2;  // squared indices over the mesh's u and v, and height from 0 to air_height
uniform float air_height;
uniform int air_steps;

float index2_at(vec3 at) {
  float nodes = float(textureSize(air_index2, 0).z);
  return textureLod(air_index2, vec3(at.xy, (clamp(at.z, 0.0, 1.0) * (nodes - 1.0) + 0.5) / nodes), 0.0).r;
}

// Half the gradient of the squared index [1/m].
vec3 pull_at(vec3 at, vec3 units_per_metre) {
  vec3 reach = 0.5 / vec3(textureSize(air_index2, 0));
  vec3 pull;
  for (int axis = 0; axis < 3; ++axis) {
    vec3 aside = vec3(0.0);
    aside[axis] = reach[axis];
    vec3 low = at - aside, high = at + aside;
    if (axis == 2) low.z = max(low.z, 0.0), high.z = min(high.z, 1.0);
    pull[axis] = (index2_at(high) - index2_at(low)) / (high[axis] - low[axis]);
  }
  return 0.5 * pull * units_per_metre;
}

// Follows the view ray `v`, which straight would meet the mesh at the frame's origin, from where it enters the air: with
// the path parameter σ, dσ = ds / n, it obeys d²p/dσ² = ∇(n²)/2 (leapfrog). The ray comes to the mesh, at `p` along `v`, or
// leaves upwards from `p` along `v`, or meets an object, whose radiance is `color`.
const int kComesDown = 0, kLeaves = 1, kMeetsObject = 2;
int bend_through_air(vec2 uv, vec2 uv_per_metre, out vec3 p, inout vec3 v, out vec3 color) {
  vec3 units = vec3(uv_per_metre, 1.0 / air_height);
  float way = air_height / -v.z;
  p = -way * v;
  vec3 momentum = v * sqrt(index2_at(vec3(uv, 0.0) + p * units));
  // A ray that just turns at the ground goes four times as far, if the squared index is linear in height.
  float stride = 4.0 * way / float(air_steps);
  for (int i = 0; i < air_steps; ++i) {
    vec3 at = vec3(uv, 0.0) + p * units;
    float h = stride / length(momentum);
    momentum += 0.5 * h * pull_at(at, units);
    vec3 before = p;
    p += h * momentum;
    momentum += 0.5 * h * pull_at(vec3(uv, 0.0) + p * units, units);
#ifdef OBJECTS
    vec2 place;
    float behind = behind_objects(to_world_point(p), place);
    if (behind >= 0.0 && behind < 2.0 * stride) {
      color = textureLod(scene_color, place, 0.0).rgb;
      return kMeetsObject;
    }
#endif
    if (p.z <= 0.0) {
      p = mix(before, p, before.z / (before.z - p.z));
      p.z = 0.0;
      v = normalize(momentum);
      return kComesDown;
    }
    if (p.z > air_height && momentum.z > 0.0) break;
  }
  v = normalize(momentum);
  return v.z < 0.0 ? kComesDown : kLeaves;  // down: so near that the steps gave out
}
