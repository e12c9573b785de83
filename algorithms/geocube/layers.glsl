// The exit of a ray by a multilayer geocube. C++ twin: layers.hpp, which tells what each step is for.
layout(binding = 4) uniform sampler2DArray cube_inners;  // inner normal and R_C there

// Texels of the bordered faces: x, y, and the first layer of the cube's face.
ivec3 layer_texel(ivec3 texel, int k) { return ivec3(texel.xy, texel.z + 6 * k); }

struct Place {
  float depth;
  int layer;
  bool outer;
};
Place place_in(ivec3 texel, float l) {
  Place best = Place(-kFar, 0, true);
  for (int k = 0; k < cube_layers; ++k) {
    float d = texelFetch(cube_bounds, layer_texel(texel, k), 0).x;
    if (d <= 0.0) break;
    float to_outer = d - l;
    float to_inner = k == 0 ? kFar : l - texelFetch(cube_planes, layer_texel(texel, k), 0).w;
    float depth = min(to_outer, to_inner);
    if (depth > best.depth) best = Place(depth, k, to_outer <= to_inner);
  }
  return best;
}

struct Field {
  float depth;
  vec3 normal;
  ivec3 nearest;
  Place place;
};
Field field_at(int cube, vec3 v, float l) {
  vec3 point = cube_point(v);
  float n = float(textureSize(cube_bounds, 0).x) - 2.0;
  vec2 x = (point.xy * 0.5 + 0.5) * n + 0.5;
  vec2 base = floor(x), part = x - base;
  float most = 8.0 / n * l;
  Field field = Field(0.0, vec3(0.0), ivec3(0), Place(-kFar, 0, true));
  float largest = -1.0;
  for (int i = 0; i < 4; ++i) {
    vec2 side = vec2(float(i & 1), float(i >> 1));
    vec2 share = mix(1.0 - part, part, side);
    float weight = share.x * share.y;
    if (weight <= 0.0) continue;
    ivec3 texel = ivec3(ivec2(base + side), cube * cube_layers * 6 + int(point.z));
    Place place = place_in(texel, l);
    ivec3 at = layer_texel(texel, place.layer);
    field.depth += weight * clamp(place.depth, -most, most);
    field.normal += weight * (place.outer ? texelFetch(cube_planes, at, 0).xyz : texelFetch(cube_inners, at, 0).xyz);
    if (weight <= largest) continue;
    largest = weight;
    field.nearest = texel;
    field.place = place;
  }
  return field;
}

float allowed_layer_step(Field field, vec3 v, float l, vec3 h) {
  ivec3 at = layer_texel(field.nearest, field.place.layer);
  vec4 bounds = texelFetch(cube_bounds, at, 0), plane = texelFetch(cube_planes, at, 0);
  if (field.place.layer == 0) return allowed_step(CubeSample(bounds, plane), v, l, h);
  vec3 inner_n = texelFetch(cube_inners, at, 0).xyz;
  float d = bounds.x, from = plane.w, hv = dot(h, v);
  float halved = max(0.5 * (d - from), 1e-20), middle = 0.5 * (d + from);
  float a = l > middle ? halved * cone_step((l - middle) / halved, -hv, -hv, 1.0, bounds.y)
                       : halved * cone_step((middle - l) / halved, hv, hv, 1.0, bounds.y);
  float b = l * cone_wall(bounds.z, -hv);
  float outwards = dot(h, plane.xyz), inwards = dot(h, inner_n);
  if (outwards > 0.0) b = min(b, (d - l) * dot(v, plane.xyz) / outwards);
  if (inwards > 0.0) b = min(b, (from - l) * dot(v, inner_n) / inwards);
  float allowed = max(a < kFar ? a : 0.0, b < kFar ? b : 0.0);
  return min(allowed, 2.0 * d);
}

Exit find_exit_in_layers(vec3 p, vec3 normal, vec3 h, int cube) {
  vec3 o = cube_spheres[cube].xyz;
  float sphere = cube_spheres[cube].w;
  float t = min_step;
  if (-dot(h, normal) >= cosine_c - 1e-4) {
    float l = length(p - o);
    vec3 point = cube_point(p - o);
    int n = textureSize(cube_bounds, 0).x - 2;
    ivec2 cell = clamp(ivec2((point.xy * 0.5 + 0.5) * float(n)), ivec2(0), ivec2(n - 1));
    ivec3 texel = ivec3(cell + 1, cube * cube_layers * 6 + int(point.z));
    float least = kFar, radius = 0.0;
    for (int k = 0; k < cube_layers; ++k) {
      ivec3 at = layer_texel(texel, k);
      vec4 bounds = texelFetch(cube_bounds, at, 0);
      if (bounds.x <= 0.0) break;
      float outer = abs(bounds.x - l), inner = k == 0 ? kFar : abs(texelFetch(cube_planes, at, 0).w - l);
      if (min(outer, inner) >= least) continue;
      least = min(outer, inner);
      radius = outer <= inner ? bounds.w : texelFetch(cube_inners, at, 0).w;
    }
    t = max(t, radius);
  }
  Exit result;
  result.steps = 0;
  result.cube = cube;
  float inside = 0.0, depth_inside = min_step, outside = kFar, depth_outside = 0.0;
  bool found = false;
  Field field = Field(0.0, vec3(0.0), ivec3(0), Place(-kFar, 0, true));
  for (; !found && result.steps < iterations; ) {
    ++result.steps;
    vec3 w = p + t * h - o;
    float l = max(length(w), 1e-20);
    vec3 v = w / l;
    if (l < sphere) {
      inside = t;
      depth_inside = sphere - l;
      t += max(sphere * sphere_step(l / sphere, dot(h, v)), min_step);
      continue;
    }
    field = field_at(cube, v, l);
    if (field.depth > 0.0) {
      inside = t;
      depth_inside = field.depth;
      float allowed = field.place.depth > 0.0 ? allowed_layer_step(field, v, l, h) : 0.0;
      t += max(allowed, min_step);
      continue;
    }
    found = dot(h, field.normal) > 0.0;
    outside = t;
    depth_outside = field.depth;
    if (!found) t += min_step;
  }
  result.bounded = !found;
  for (int k = 0; found && k < 2 * refine; ++k) {
    float share = depth_inside / max(depth_inside - depth_outside, 1e-20);
    t = inside + clamp(share, 0.02, 0.98) * (outside - inside);
    vec3 w = p + t * h - o;
    float l = max(length(w), 1e-20);
    field = field_at(cube, w / l, l);
    if (field.depth > 0.0) {
      inside = t;
      depth_inside = field.depth;
    } else {
      outside = t;
      depth_outside = field.depth;
    }
  }
  result.point = p + t * h;
  result.path = t;
  result.clear = 0.0;
  result.normal = leaving_normal(field.normal, h);
  return result;
}
