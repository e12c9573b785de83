// The valid sampling path of a viewing ray in a hull (Sec. 3.2, Fig. 4). C++ twin: algorithms/shaders/valid_path.hpp.

// Length [m] of the path from s, read from the local-coordinates map, to s^F on the front face. s is projected onto the
// viewing ray: rounding to 8 bits moves it off the ray, and on a short path even past s^F, where the path has no length.
// `ray`: unit where the points are in the world; for local coordinates, that times the transposed map to the world.
float valid_path_length(vec3 s, vec3 sf, vec3 ray) { return max(dot(s - sf, ray), 0.0); }

// Eq. 1 and 2 as distance from the eye's side: how far behind s^F the i-th of N points lies. `offset` is its place in its
// step: 0 at the back, as in the paper.
float sample_distance(float path_length, float i, float count, float offset) {
  return path_length * (1.0 - (i + offset) / count);
}

// Eq. 3: the same for the half-way point behind the i-th of N points, or with i = N before the last. s^S_0 would lie half a
// step beyond the path, inside the object that ends it: both ends are held on the path.
float half_way_distance(float path_length, float i, float count, float offset) {
  return clamp(sample_distance(path_length, i - 0.5, count, offset), 0.0, path_length);
}
