// Where a ray leaves the solid: Chan and Wang 2005, Sec. 2.2 and 2.3. C++ twin: search.hpp, which tells what each step is for.
#include "algorithms/geocube/cube_maps.glsl"
#include "algorithms/geocube/functions.glsl"

#ifndef CUBES
#define CUBES 3  // 1, 2, or any number
#endif
uniform int iterations;
uniform int refine;
uniform int switches;
uniform bool ask_always;
uniform float min_step;
uniform float cosine_c;

struct Exit {
  vec3 point;
  vec3 normal;
  float path;
  int steps;
  int cube;
  bool bounded;
  float clear;  // R_C there
};

float allowed_step(CubeSample s, vec3 v, float l, vec3 h) {
  float d = s.bounds.x, hv = dot(h, v);
  float a = d * cone_step(l / d, -hv, -hv, 1.0, s.bounds.y);
  float b = d * cone_step((d - l) / d, hv, dot(h, s.plane.xyz), dot(v, s.plane.xyz), s.bounds.z);
  float allowed = max(a < kFar ? a : 0.0, b < kFar ? b : 0.0);
  return min(allowed, 2.0 * d);
}

int next_cube(vec3 v, float l, int current, uint asked) {
#if CUBES == 1
  return -1;
#elif CUBES == 2
  return cube_count == 2 && (asked >> uint(1 - current) & 1u) == 0u ? 1 - current : -1;
#else
  vec3 centre = cube_spheres[current].xyz;
  int best = -1;
  float least = kFar;
  for (int i = 0; i < cube_count; ++i) {
    float away = abs(dot(cube_spheres[i].xyz - centre, v) - l);
    if ((asked >> uint(i) & 1u) != 0u || away >= least) continue;
    least = away;
    best = i;
  }
  return best;
#endif
}

// How far cone C clears the way, at least the minimum step.
float first_step(vec3 p, vec3 normal, vec3 h, int cube) {
  if (-dot(h, normal) < cosine_c - 1e-4) return min_step;
  return max(min_step, fetch_bounds(cube, p - cube_spheres[cube].xyz).w);
}

// The march from p + t h; `inside` becomes the last place known to be inside, `found` tells whether t lies beyond the exit,
// v and s are of the last place outside of a cube. One loop, in which asking another cube is a turn like any other: wide
// vectors execute both sides of a branch, and fetches on either cost alike.
void march(vec3 p, vec3 h, int most, inout int cube, inout float t, inout float inside, inout int steps, out bool found,
           out vec3 v, out CubeSample s) {
  found = false;
  v = vec3(0.0);
  s = CubeSample(vec4(0.0), vec4(0.0));
  int home = cube, asks = 0;  // who had the point outside, and how many others were asked since
  float l_home = 0.0;
  uint asked = 0u;
  while (!found && (steps < most || asks > 0)) {
    vec4 sphere = cube_spheres[cube];
    vec3 w = p + t * h - sphere.xyz;
    float l = max(length(w), 1e-20);
    vec3 u = w / l;
    CubeSample here = fetch_cube(cube, u);
    bool in_sphere = l < sphere.w;
    float allowed = in_sphere ? sphere.w * sphere_step(l / sphere.w, dot(h, u)) : allowed_step(here, u, l, h);
    if (in_sphere || l < here.bounds.x) {
      if (steps < most) {
        inside = t;
        t += max(allowed, min_step);
        ++steps;
      }
      home = cube;
      asks = 0;
      continue;
    }
    if (asks == 0) {
      ++steps;
      v = u;
      s = here;
      l_home = l;
      asked = 0u;
    }
    asked |= 1u << uint(cube);
    bool ask = asks < switches && (ask_always || s.plane.w > 0.0);
    int other = ask ? next_cube(v, l_home, home, asked) : -1;
    ++asks;
    cube = other;
    if (other >= 0) continue;
    // Nobody sees it: through the surface, or, of a ray that heads inwards, only beneath the sampled one.
    cube = home;
    asks = 0;
    found = dot(h, s.plane.xyz) > 0.0;
    if (!found) t += min_step;
  }
}

// From the plane at S back to the surface, or half-way where that leads out of the known interval.
float corrected(vec3 p, vec3 h, int cube, vec3 v, CubeSample s, float t, float inside, float outside) {
  float slope = dot(h, s.plane.xyz);
  vec3 to_s = cube_spheres[cube].xyz + s.bounds.x * v - (p + t * h);
  float next = slope > 1e-6 ? t + dot(to_s, s.plane.xyz) / slope : kFar;
  float rounding = 0.01 * min_step;
  bool near = next >= inside - rounding && next <= outside + rounding;
  return near ? clamp(next, inside, outside) : 0.5 * (inside + min(outside, t));
}

// The unit normal where the ray leaves, by the texels' mean.
vec3 leaving_normal(vec3 mean, vec3 h) { return normalize(mean + 4.0 * max(0.95 - length(mean), 0.0) * h); }

// `start`: how far the way is known to be clear.
Exit find_exit(vec3 p, vec3 h, int cube, float start) {
  float t = start;
  Exit result;
  result.steps = 0;
  float inside = 0.0;
  bool found;
  vec3 v;
  CubeSample s;
  march(p, h, iterations, cube, t, inside, result.steps, found, v, s);
  float outside = found ? t : kFar;
  result.bounded = !found;
  int corrections = found ? refine : 1;
  for (int k = 0; k < corrections; ++k) {
    if (found) t = corrected(p, h, cube, v, s, t, inside, outside);
    vec3 w = p + t * h - cube_spheres[cube].xyz;
    float l = max(length(w), 1e-20);
    v = w / l;
    s = fetch_cube(cube, v);
    if (l < s.bounds.x)
      inside = t;
    else
      outside = t;
  }
  result.point = found && refine > 0 ? p + t * h : cube_spheres[cube].xyz + s.bounds.x * v;
  result.path = t;
  result.cube = cube;
  result.normal = leaving_normal(s.plane.xyz, h);
  result.clear = s.bounds.w;
  return result;
}

#ifdef LAYERS
#include "algorithms/geocube/layers.glsl"
#endif

// By whichever kind of cubes there is; `start` as first_step() and next_start() tell it.
Exit trace_inside(vec3 p, vec3 normal, vec3 h, int cube, float start) {
#ifdef LAYERS
  return find_exit_in_layers(p, normal, h, cube);
#else
  return find_exit(p, h, cube, start);
#endif
}

// This serves a ray that goes on from an exit: its last fetch told how far cone C clears the way.
float next_start(Exit from, vec3 h) {
  return -dot(h, from.normal) < cosine_c - 1e-4 ? min_step : max(min_step, from.clear);
}
