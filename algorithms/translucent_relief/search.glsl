// Where a ray meets a height field (Timonen, Sec. 2 and 3). C++ twin: algorithms/translucent_relief/search.hpp.
// The includer defines `float above(int layer, Ray ray, float t)`: the height of the ray's point t over the layer [m].

// In the frame of a surface point: z along its normal, metres.
struct Ray {
  vec3 origin;
  vec3 direction;  // unit
  vec2 uv;         // of the mesh, at the frame's origin
  vec2 uv_per_metre;
};

vec2 uv_at(Ray ray, float t) { return ray.uv + (ray.origin.xy + t * ray.direction.xy) * ray.uv_per_metre; }
float z_at(Ray ray, float t) { return ray.origin.z + t * ray.direction.z; }

float above(int layer, Ray ray, float t);

// The part of the ray that lies in a slab of heights and, where rays do not leave the mesh's texture, in [0, 1]² of it;
// empty where x > y. `from`: where the ray begins.
vec2 clip_ray(Ray ray, float low, float high, bool cut, float from) {
  vec3 position = vec3(ray.uv + ray.origin.xy * ray.uv_per_metre, ray.origin.z);
  vec3 speed = vec3(ray.direction.xy * ray.uv_per_metre, ray.direction.z);
  speed = mix(speed, vec3(1e-9), lessThan(abs(speed), vec3(1e-9)));
  // No loop: llvmpipe's compiler takes exponentially long for many loops one after the other.
  vec3 a = (vec3(0.0, 0.0, low) - position) / speed, b = (vec3(1.0, 1.0, high) - position) / speed;
  vec3 first = min(a, b), last = max(a, b);
  vec2 range = vec2(max(from, first.z), min(1e9, last.z));
  if (cut) range = vec2(max(range.x, max(first.x, first.y)), min(range.y, min(last.x, last.y)));
  return range;
}

// The first crossing in `range` of a ray that begins on `side` of the layer (1: above it, −1: below): a linear search, then
// halving (Policarpo et al. 2005), then the chord of the last bracket (Tatarchuk 2006). Negative where there is none.
// A point less than `bias` metres beyond counts as on it, for the sake of rays that start there. `taken` counts the heights
// that were asked for.
float linear_crossing(int layer, Ray ray, vec2 range, float side, float bias, int steps, int refinements,
                      inout float taken) {
  if (!(range.x < range.y)) return -1.0;
  float stride = (range.y - range.x) / float(steps);
  float before = range.x, after = range.x, height_before = max(side * above(layer, ray, range.x), 0.0), height_after = 0.0;
  taken += 1.0;
  bool found = false;
  for (int i = 1; i <= steps; ++i) {
    after = range.x + stride * float(i);
    height_after = side * above(layer, ray, after);
    taken += 1.0;
    if (height_after < -bias) {
      found = true;
      break;
    }
    before = after;
    height_before = max(height_after, 0.0);
  }
  if (!found) return -1.0;
  for (int i = 0; i < refinements; ++i) {
    float middle = 0.5 * (before + after);
    float height = side * above(layer, ray, middle);
    taken += 1.0;
    if (height < 0.0) {
      after = middle;
      height_after = height;
    } else {
      before = middle;
      height_before = height;
    }
  }
  return before + (after - before) * clamp(height_before / (height_before - height_after), 0.0, 1.0);
}
