// Where a ray meets the environment that a distance impostor stores (Sec. 2). C++ twin: hit_search.hpp.
// ITERATIONS is NITER; SCHEME is 0 secant, 1 false position, 2 linear with LINEAR_STEPS steps.
#ifndef IMPOSTOR_MAP
#define IMPOSTOR_MAP samplerCube
#define IMPOSTOR_DISTANCE(map, direction) textureLod(map, direction, 0.0).a
#endif

// The least denominator of Eq. 6.
const float kLeastDifference = 1e-7;

#ifdef BARE
// As many fetches as the search makes, nearby, and nothing else.
vec3 find_hit(vec3 x, vec3 R, IMPOSTOR_MAP map) {
  float sum = 0.0;
  vec3 direction = R;
  for (int i = 0; i < BARE; ++i) {
    sum += IMPOSTOR_DISTANCE(map, direction);
    direction += 0.1 * x;
  }
  return direction + 1e-9 * sum * x;
}
#elif SCHEME == 2
bool beyond_surface(IMPOSTOR_MAP map, vec3 from, vec3 across, float height, float theta, float phi) {
  vec3 direction = cos(phi) * from + sin(phi) * across;
  return height >= IMPOSTOR_DISTANCE(map, direction) * sin(theta - phi);
}

// Equal steps of the angle φ that the direction from o turns by; |x| sin θ / sin(θ − φ) from o lies the point there.
vec3 find_hit(vec3 x, vec3 R, IMPOSTOR_MAP map) {
  float r = length(x);
  if (r < 1e-6) return R * IMPOSTOR_DISTANCE(map, R);
  vec3 from = x / r;
  float cosine = clamp(dot(from, R), -1.0, 1.0);
  vec3 across = R - cosine * from;
  float sine = length(across);
  if (sine < 1e-4 && cosine > 0.0) return R * max(IMPOSTOR_DISTANCE(map, R), r);
  if (sine < 1e-4) across = cross(from, abs(from.x) < 0.7 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0));
  across = normalize(across);
  float theta = min(atan(sine, cosine), 3.1405927);
  float height = r * sin(theta);
  float low = 0.0, high = theta;
  bool under = false, found = false;
  for (int i = 0; i < LINEAR_STEPS && !found; ++i) {
    float phi = theta * float(i) / float(LINEAR_STEPS);
    bool beyond = beyond_surface(map, from, across, height, theta, phi);
    if (beyond && under) {
      high = phi;
      found = true;
    } else {
      low = phi;
      under = !beyond;
    }
  }
  if (!found && !under) return R * IMPOSTOR_DISTANCE(map, R);
  for (int i = 0; i < ITERATIONS; ++i) {
    float middle = 0.5 * (low + high);
    if (beyond_surface(map, from, across, height, theta, middle)) high = middle; else low = middle;
  }
  float phi = 0.5 * (low + high);
  return (cos(phi) * from + sin(phi) * across) * (height / max(sin(theta - phi), 1e-6));
}
#else
vec3 find_hit(vec3 x, vec3 R, IMPOSTOR_MAP map) {
  // p, as if the surface stood across R at r: d_p = |r| − R·x. `ppp` is |p| / |p'|.
  float r = IMPOSTOR_DISTANCE(map, R);
  float dp = max(r - dot(x, R), 0.0);
  vec3 p = x + R * dp;
#if ITERATIONS >= 0
  float ppp = length(p) / IMPOSTOR_DISTANCE(map, p);
  // Eq. 4
  float dl = max(dp + r * (1.0 - ppp), 0.0);
  vec3 l = x + R * dl;
#if SCHEME == 0
  // Eq. 6 with p and l, whatever their kinds.
  for (int i = 0; i < ITERATIONS; ++i) {
    float llp = length(l) / IMPOSTOR_DISTANCE(map, l);
    float difference = llp - ppp;
    float new_step = abs(difference) > kLeastDifference ? (dl - dp) * (1.0 - llp) / difference : 0.0;
    dp = dl;
    ppp = llp;
    dl = max(dl + new_step, 0.0);
    l = x + R * dl;
  }
#else
  // The last undershooting and overshooting points; 0: none yet, the point at infinity in the direction R stands in.
  float dun = 0.0, dov = 0.0, pun = ppp, pov = ppp;
  if (ppp < 1.0) dun = dp; else dov = dp;
  for (int i = 0; i < ITERATIONS; ++i) {
    float llp = length(l) / IMPOSTOR_DISTANCE(map, l);
    float new_step;
    if (llp < 1.0) {
      dun = dl;
      pun = llp;
      new_step = dov == 0.0 ? r * (1.0 - llp) : (dl - dov) * (1.0 - llp) / (llp - pov);
    } else {
      dov = dl;
      pov = llp;
      new_step = dun == 0.0 ? r * (1.0 - llp) : (dl - dun) * (1.0 - llp) / (llp - pun);
    }
    dl = max(dl + new_step, 0.0);  // the ray must not flip
    l = x + R * dl;
  }
#endif
  return l;
#else
  return p;
#endif
}
#endif
