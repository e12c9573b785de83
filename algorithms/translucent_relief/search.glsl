// Where a ray meets a height field (Timonen, Sec. 2 and 3). C++ twin: algorithms/translucent_relief/search.hpp.
// The includer defines `float above(int layer, vec3 at)`: the height over the layer [m] of a point at `xy` of the layers' maps
// and the height `z` [m].

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

// The ray's point as above() takes it, with maps that repeat `tiles` times over the mesh's texture.
vec3 over_map(Ray ray, vec2 tiles, float t) { return vec3(tiles * uv_at(ray, t), z_at(ray, t)); }

float above(int layer, vec3 at);

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
  float last = float(steps), stride = (range.y - range.x) / last;
  vec3 first = over_map(ray, tiles, range.x);
  vec3 by = stride * vec3(tiles * ray.uv_per_metre * ray.direction.xy, ray.direction.z);
  float start = side * above(layer, first), k = 0.0;  // the height after k steps
  vec4 heights = vec4(0.0);                           // and after the four that follow
  for (; k < last; k += 4.0) {
    vec3 at = first + k * by;
    heights = side * vec4(above(layer, at + by), above(layer, at + 2.0 * by), above(layer, at + 3.0 * by),
                          above(layer, at + 4.0 * by));
    if (min(min(heights.x, heights.y), min(heights.z, heights.w)) < -bias) break;
    start = heights.w;
  }
  taken += 1.0 + min(k + 4.0, 4.0 * ceil(0.25 * last));
  bvec4 below = lessThan(heights, vec4(-bias));
  // How many of the four are before the one that is below, and the heights on both sides of it.
  vec3 bracket = below.x ? vec3(0.0, start, heights.x)
                 : below.y ? vec3(1.0, heights.xy)
                 : below.z ? vec3(2.0, heights.yz)
                           : vec3(3.0, heights.zw);
  float before = k + bracket.x, after = before + 1.0;
  if (after > last) return -1.0;
  float height_before = max(bracket.y, 0.0), height_after = bracket.z;
  for (int i = 0; i < refinements; ++i) {
    float middle = 0.5 * (before + after);
    float height = side * above(layer, first + middle * by);
    bool beyond = height < 0.0;
    after = beyond ? middle : after;
    height_after = beyond ? height : height_after;
    before = beyond ? before : middle;
    height_before = beyond ? height_before : height;
  }
  taken += float(refinements);
  float share = clamp(height_before / (height_before - height_after), 0.0, 1.0);
  return range.x + stride * (before + (after - before) * share);
}
