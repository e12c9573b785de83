// Rays against a height field through a pyramid of its greatest and least heights (Tevs et al. 2008), exact in the cells
// between texel centres. C++ twin: HeightField::crossing (algorithms/reference/relief/height_field.cpp), without the pyramid.
// The includer defines extremes(), corners(), map_size() and pyramid_top().

vec2 extremes(int layer, ivec2 cell, int level);  // greatest and least height [m] of the cell of 2^level × 2^level
vec4 corners(int layer, ivec2 cell);              // heights [m] at a cell's corners: (0, 0), (1, 0), (0, 1), (1, 1)
ivec2 map_size(int layer);
int pyramid_top(int layer);

// The first t in [0, end] where a t² + b t + c falls through 0; 0 itself if `at_begin` and it is no more than 0 there and
// falls; −1 where it does not.
float first_fall(float a, float b, float c, float end, bool at_begin) {
  if (at_begin && c <= 0.0 && b < 0.0) return 0.0;
  float at_end = (a * end + b) * end + c;
  float discriminant = b * b - 4.0 * a * c;
  if (abs(a) * end <= 1e-6 * abs(b)) {
    float root = -c / b;
    if (b < 0.0 && root >= 0.0 && root <= end) return root;
  } else if (discriminant >= 0.0) {
    float q = -0.5 * (b + (b < 0.0 ? -1.0 : 1.0) * sqrt(discriminant));
    vec2 roots = vec2(q / a, q != 0.0 ? c / q : -1.0);
    if (roots.x > roots.y) roots = roots.yx;
    for (int i = 0; i < 2; ++i) {
      if (roots[i] >= 0.0 && roots[i] <= end && 2.0 * a * roots[i] + b < 0.0) return roots[i];
    }
  }
  return c > 0.0 && at_end < 0.0 ? end : -1.0;
}

// As linear_crossing(); `visits` bounds the cells of the pyramid that are asked, and `taken` counts them.
float max_mip_crossing(int layer, Ray ray, vec2 tiles, vec2 range, float side, int visits, inout float taken) {
  if (!(range.x < range.y)) return -1.0;
  // In units of cells, whole numbers at the texels' centres.
  vec2 texels = tiles * vec2(map_size(layer));
  vec2 start = uv_at(ray, 0.0) * texels - 0.5;
  vec2 speed = ray.direction.xy * ray.uv_per_metre * texels;
  vec2 forward = vec2(speed.x < 0.0 ? -1.0 : 1.0, speed.y < 0.0 ? -1.0 : 1.0);
  vec2 inverse = 1.0 / (forward * max(abs(speed), vec2(1e-12)));
  int top = pyramid_top(layer);
  int level = min(top, 3);
  float t = range.x;
  bool at_begin = true;
  for (int i = 0; i < visits && t < range.y; ++i) {
    float width = exp2(float(level));
    // A point on a border belongs to the cell ahead, whatever rounding says.
    vec2 cell = floor((start + t * speed + 1e-3 * forward) / width);
    vec2 borders = ((cell + max(forward, 0.0)) * width - start) * inverse;
    float end = min(max(min(borders.x, borders.y), t), range.y);
    vec2 bounds = extremes(layer, ivec2(cell), level);
    taken += 1.0;
    float z0 = z_at(ray, t), z1 = z_at(ray, end);
    if (side > 0.0 ? min(z0, z1) > bounds.x : max(z0, z1) < bounds.y) {
      t = max(end, t + 1e-6 * abs(range.y));
      level = min(level + 1, top);
      at_begin = false;
      continue;
    }
    if (level > 0) {
      --level;
      continue;
    }
    vec4 h = corners(layer, ivec2(cell));
    vec2 f = start + t * speed - cell;
    vec2 along = h.yz - h.x;
    float twist = h.w - h.y - h.z + h.x;
    float a = -side * twist * speed.x * speed.y;
    float b = side * (ray.direction.z - (along.x + twist * f.y) * speed.x - (along.y + twist * f.x) * speed.y);
    float c = side * (z0 - (h.x + along.x * f.x + along.y * f.y + twist * f.x * f.y));
    float fall = first_fall(a, b, c, end - t, at_begin);
    if (fall >= 0.0) return t + fall;
    t = max(end, t + 1e-6 * abs(range.y));
    level = min(level + 1, top);
    at_begin = false;
  }
  return -1.0;
}
