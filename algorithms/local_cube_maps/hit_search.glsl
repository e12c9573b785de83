// Where a ray meets the environment that a distance impostor stores (Sec. 2). C++ twin: hit_search.hpp.
// ITERATIONS is NITER; SCHEME is 0 secant, 1 false position, 2 linear with LINEAR_STEPS steps, 3 the
// same followed by false position.
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
#elif SCHEME >= 2
// The angle φ that the direction from o turns by, up to θ; |x| sin θ / sin(θ − φ) from o lies the point there.
struct Turn {
  vec3 from, across;
  float theta, height;
};
// False where the ray runs along one direction.
bool turns(vec3 x, vec3 R, out Turn turn) {
  float r = length(x);
  if (r < 1e-6) return false;
  turn.from = x / r;
  float cosine = clamp(dot(turn.from, R), -1.0, 1.0);
  turn.across = R - cosine * turn.from;
  float sine = length(turn.across);
  if (sine < 1e-4 && cosine > 0.0) return false;
  if (sine < 1e-4)
    turn.across = cross(turn.from, abs(turn.from.x) < 0.7 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0));
  turn.across = normalize(turn.across);
  turn.theta = min(atan(sine, cosine), 3.1405927);
  turn.height = r * sin(turn.theta);
  return true;
}
vec3 direction_at(Turn turn, float phi) { return cos(phi) * turn.from + sin(phi) * turn.across; }

#if SCHEME == 2
bool beyond_surface(IMPOSTOR_MAP map, Turn turn, float phi) {
  return turn.height >= IMPOSTOR_DISTANCE(map, direction_at(turn, phi)) * sin(turn.theta - phi);
}

vec3 find_hit(vec3 x, vec3 R, IMPOSTOR_MAP map) {
  Turn turn;
  if (!turns(x, R, turn)) return R * max(IMPOSTOR_DISTANCE(map, R), length(x));
  float low = 0.0, high = turn.theta;
  bool under = false, found = false;
  for (int i = 0; i < LINEAR_STEPS && !found; ++i) {
    float phi = turn.theta * float(i) / float(LINEAR_STEPS);
    bool beyond = beyond_surface(map, turn, phi);
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
    if (beyond_surface(map, turn, middle)) high = middle; else low = middle;
  }
  float phi = 0.5 * (low + high);
  return direction_at(turn, phi) * (turn.height / max(sin(turn.theta - phi), 1e-6));
}
#else
// Eq. 6 with an undershooting point and an overshooting one; without the latter the point at infinity stands in.
float next_guess(bool found, float dun, float pun, float dov, float pov, float r) {
  return found ? dun + (dov - dun) * (1.0 - pun) / (pov - pun) : dun + r * (1.0 - pun);
}

vec3 find_hit(vec3 x, vec3 R, IMPOSTOR_MAP map) {
  Turn turn;
  float r = IMPOSTOR_DISTANCE(map, R);
  if (!turns(x, R, turn)) return R * max(r, length(x));
  float dun = 0.0, dov = 0.0, pun = 0.0, pov = 0.0;
  bool under = false, found = false;
  for (int i = 0; i < LINEAR_STEPS && !found; ++i) {
    float phi = turn.theta * float(i) / float(LINEAR_STEPS);
    float away = sin(turn.theta - phi);
    float d = length(x) * sin(phi) / away;
    float llp = turn.height / (away * IMPOSTOR_DISTANCE(map, direction_at(turn, phi)));
    if (llp >= 1.0 && under) {
      dov = d;
      pov = llp;
      found = true;
    } else {
      dun = d;
      pun = llp;
      under = llp < 1.0;
    }
  }
  if (!under) return R * r;
  float dl = next_guess(found, dun, pun, dov, pov, r);
  for (int i = 0; i < ITERATIONS; ++i) {
    vec3 l = x + R * dl;
    float llp = length(l) / IMPOSTOR_DISTANCE(map, l);
    if (llp < 1.0) {
      dun = dl;
      pun = llp;
    } else {
      dov = dl;
      pov = llp;
      found = true;
    }
    dl = next_guess(found, dun, pun, dov, pov, r);
  }
  return x + R * dl;
}
#endif
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
