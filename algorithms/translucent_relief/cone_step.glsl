// Rays against a height field through a map of empty cones (Dummer 2006), which cone_map() makes, or of relaxed ones (Policarpo
// and Oliveira 2007) by relaxed_cone_map() (height_pyramid.cpp). The includer defines height_at() of search.glsl and cone_at().

// As linear_crossing(), from above only, through a map of cones: cone_at() gives their width over their height at a point of
// the mesh's texture, both in units of the map, for rays that rise or fall; `range_m` is the layer's height and `tiles` as
// often as the map repeats. Where a step ends in the surface, as it may in a relaxed cone, halving and the chord of the last
// bracket follow.
float cone_at(int layer, vec2 at, bool falls);
float cone_crossing(int layer, Ray ray, vec2 tiles, float range_m, vec2 range, float bias, int steps, int refinements,
                    inout float taken) {
  if (!(range.x < range.y)) return -1.0;
  float across = length(ray.direction.xy * ray.uv_per_metre * tiles);  // of the map, for each metre
  float upward = ray.direction.z / range_m;
  // On a surface cones have no width: at least as far as equal steps go.
  float least = (range.y - range.x) / float(steps);
  float before = range.x, height_before = 0.0, t = range.x;
  for (int i = 0; i < steps; ++i) {
    float height = above(layer, ray, tiles, t);
    taken += 1.0;
    if (height < -bias && t > range.x) {
      for (int k = 0; k < refinements; ++k) {
        float middle = 0.5 * (before + t), at_middle = above(layer, ray, tiles, middle);
        taken += 1.0;
        if (at_middle < 0.0) {
          t = middle;
          height = at_middle;
        } else {
          before = middle;
          height_before = at_middle;
        }
      }
      return before + (t - before) * (height_before / (height_before - height));
    }
    before = t;
    height_before = max(height, 0.0);
    float closing = across / max(cone_at(layer, tiles * uv_at(ray, t), upward < 0.0), 1e-4) - upward;
    float step = closing > 0.0 ? height_before / range_m / closing : range.y;
    t += max(step, least);
    if (t >= range.y) {
      t = range.y;
      if (above(layer, ray, tiles, t) >= -bias) return -1.0;
    }
  }
  return upward < 0.0 ? t : -1.0;  // so near that the steps gave out; upwards it runs along the surface
}
