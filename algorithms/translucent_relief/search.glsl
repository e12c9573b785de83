// Where a ray meets a height field (Timonen, Sec. 2 and 3). C++ twin: algorithms/translucent_relief/search.hpp.
// The includer defines `vec2 units_of(int layer)` and `float height_at(int layer, vec2 at)`: at a place of its map the layer's
// height [m] is units.x + units.y * height_at().

// In the frame of a surface point: z along its normal, metres.
struct Ray {
  vec3 origin;
  vec3 direction;  // unit
  vec2 uv;         // of the mesh, at the frame's origin
  vec2 uv_per_metre;
};

// Rows along u, along v, and the unit normal, of a point where a unit of the mesh's u and v is so long; `metres`: how long
// in the frame, which leaves the texture's shear out.
mat3 surface_frame(vec3 n, vec3 over_u, vec3 over_v, out vec2 metres) {
  vec3 u = over_u - n * dot(n, over_u);
  metres.x = length(u);
  u /= metres.x;
  vec3 v = cross(n, u);
  metres.y = dot(v, over_v);
  if (metres.y < 0.0) v = -v;
  metres.y = abs(metres.y);
  return transpose(mat3(u, v, n));
}

vec2 uv_at(Ray ray, float t) { return ray.uv + (ray.origin.xy + t * ray.direction.xy) * ray.uv_per_metre; }
float z_at(Ray ray, float t) { return ray.origin.z + t * ray.direction.z; }

vec2 units_of(int layer);
float height_at(int layer, vec2 at);

// How far the ray's point is over the layer [m], whose map repeats `tiles` times over the mesh's texture.
float above(int layer, Ray ray, vec2 tiles, float t) {
  vec2 units = units_of(layer);
  return z_at(ray, t) - units.x - units.y * height_at(layer, tiles * uv_at(ray, t));
}

// The part of the ray that lies in a slab of heights and, where rays do not leave the mesh's texture, in [0, 1]² of it;
// empty where x > y. `from`: where the ray begins.
vec2 clip_ray(Ray ray, float low, float high, bool cut, float from) {
  vec3 position = vec3(ray.uv + ray.origin.xy * ray.uv_per_metre, ray.origin.z);
  vec3 speed = vec3(ray.direction.xy * ray.uv_per_metre, ray.direction.z);
  vec3 inverse = 1.0 / mix(speed, vec3(1e-9), lessThan(abs(speed), vec3(1e-9)));
  // No loop: llvmpipe's compiler takes exponentially long for many loops one after the other.
  vec3 a = (vec3(0.0, 0.0, low) - position) * inverse, b = (vec3(1.0, 1.0, high) - position) * inverse;
  vec3 first = min(a, b), last = max(a, b);
  vec2 range = vec2(max(from, first.z), min(1e9, last.z));
  if (cut) range = vec2(max(range.x, max(first.x, first.y)), min(range.y, min(last.x, last.y)));
  return range;
}

// The first crossing in `range` of a ray that begins on `side` of the layer (1: above it, −1: below): a linear search, then
// halving (Policarpo et al. 2005), then the chord of the last bracket (Tatarchuk 2006). Negative where there is none.
// A point less than `bias` metres beyond counts as on it, for the sake of rays that start there. `taken` counts the heights
// that were asked for: four at a time, since none of them waits for another, whichever of them is below.
float linear_crossing(int layer, Ray ray, vec2 tiles, vec2 range, float side, float bias, int steps, int refinements,
                      inout float taken) {
  if (!(range.x < range.y)) return -1.0;
  float stride = (range.y - range.x) / float(steps), end = range.y - 0.5 * stride;  // `end`: after the last but one step
  // At t the ray is z + t * rise − scale * height_at(origin + t * speed) over the layer. Loops are kept short, since
  // llvmpipe's compiler leaves in them all that stands in them.
  vec2 units = units_of(layer);
  vec2 origin = tiles * uv_at(ray, 0.0), speed = tiles * ray.uv_per_metre * ray.direction.xy;
  float z = side * (ray.origin.z - units.x), rise = side * ray.direction.z, scale = side * units.y;
  vec2 by1 = stride * speed, by2 = 2.0 * by1, by3 = 3.0 * by1, by4 = 4.0 * by1;
  vec4 climb = stride * rise * vec4(1.0, 2.0, 3.0, 4.0);
  float t = range.x, start = z + t * rise - scale * height_at(layer, origin + t * speed);  // the height at t
  vec4 heights;                                                                            // and after the next four steps
  bvec4 below;
  bool found;
  taken += 1.0;
  do {
    vec2 at = origin + t * speed;
    heights = z + t * rise + climb -
              scale * vec4(height_at(layer, at + by1), height_at(layer, at + by2), height_at(layer, at + by3),
                           height_at(layer, at + by4));
    below = lessThan(heights, vec4(-bias));
    found = any(below);
    start = found ? start : heights.w;
    t += found ? 0.0 : 4.0 * stride;
    taken += 4.0;
  } while (!found && t < end);
  // How many of the four are before the one that is below, and the heights on both sides of it.
  vec3 bracket = below.x ? vec3(0.0, start, heights.x)
                 : below.y ? vec3(1.0, heights.xy)
                 : below.z ? vec3(2.0, heights.yz)
                           : vec3(3.0, heights.zw);
  float before = t + bracket.x * stride, after = before + stride;
  if (!found || before > end) return -1.0;
  float height_before = max(bracket.y, 0.0), height_after = bracket.z;
  int i = 0;
  if (i < refinements) {
    do {
      float middle = 0.5 * (before + after);
      float height = z + middle * rise - scale * height_at(layer, origin + middle * speed);
      bool beyond = height < 0.0;
      after = beyond ? middle : after;
      height_after = beyond ? height : height_after;
      before = beyond ? before : middle;
      height_before = beyond ? height_before : height;
    } while (++i < refinements);
  }
  taken += float(refinements);
  float share = clamp(height_before / (height_before - height_after), 0.0, 1.0);
  return before + (after - before) * share;
}
