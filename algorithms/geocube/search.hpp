#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <glm/glm.hpp>

#include "algorithms/geocube/cubes.hpp"

/// Where a ray leaves the solid, by the geocube: Chan and Wang 2005, Sec. 2.2 and 2.3 and the appendix (references.bib:
/// chan2005). search.glsl is the same in GLSL; both work in single precision, in the mesh's space.
namespace pellucid::geocube {

/// "Never": farther than any step.
inline constexpr float kFar = 1e30F;

/// C*(μ, γ): from a point on a cone's axis at distance 1 from the apex to the side wall, for a ray that makes an angle
/// of cosine γ with the direction *to* the apex; μ the cosine of the half-apex angle. kFar where the ray never meets
/// the wall ahead.
inline float cone_wall(float mu, float gamma) {
  const float sine = std::sqrt(std::max(0.0F, 1.0F - mu * mu));
  const float below = gamma * sine + mu * std::sqrt(std::max(0.0F, 1.0F - gamma * gamma));
  return below > 1e-9F ? sine / below : kFar;
}

/// C(f, h, a, n, μ) of a cone of height 1 from a point on its axis at distance f from the base's centre, by its dot
/// products: h the ray, a the axis from apex to base, n the base's normal.
inline float cone_step(float f, float h_a, float h_n, float a_n, float mu) {
  const float wall = (1.0F - f) * cone_wall(mu, -h_a);
  if (h_n <= 0.0F) return wall;
  const float base = f * a_n / h_n;
  return h_a < mu ? std::min(wall, base) : base;
}

/// S*(f, γ): from a point at distance f from the centre of the unit sphere to the sphere, γ the cosine between the ray
/// and the direction from the centre.
inline float sphere_step(float f, float gamma) {
  return std::sqrt(std::max(0.0F, 1.0F - f * f * (1.0F - gamma * gamma))) - f * gamma;
}

/// A cube map's answer for a direction.
struct CubeSample {
  glm::vec4 bounds{0.0F};  ///< d, cos θ_A, cos θ_B, R_C
  glm::vec4 plane{0.0F};   ///< N, not of unit length between texels; above 0 where the inside begins again behind S
};

/// The cube maps as a shader samples them.
class CubeMaps {
 public:
  explicit CubeMaps(const CubeSet& set) : set_(&set), grid_(set.grid()) {}
  int count() const { return static_cast<int>(set_->cubes.size()); }
  glm::vec3 center(int cube) const { return glm::vec3(set_->cubes[static_cast<std::size_t>(cube)].center); }
  float sphere(int cube) const { return set_->cubes[static_cast<std::size_t>(cube)].sphere; }
  CubeSample fetch(int cube, const glm::vec3& direction) const {
    const CubeLayer& layer = set_->cubes[static_cast<std::size_t>(cube)].layers.front();
    const CubeGrid::Sample at = grid_.sample(glm::dvec3(direction));
    CubeSample result;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto weight = static_cast<float>(at.weight[k]);
      if (weight == 0.0F) continue;
      result.bounds += weight * layer.bounds[at.index[k]];
      result.plane += weight * layer.planes[at.index[k]];
    }
    return result;
  }

 private:
  const CubeSet* set_;
  CubeGrid grid_;
};

struct SearchOptions {
  int iterations = 10;  ///< the bound on steps
  float min_step = 0;   ///< δ, a length; above 0
  int refine = 2;       ///< tangent-plane steps from the point found back to the surface; 0 as in the paper
  int switches =
      1;  ///< other cubes asked before a point counts as outside, in the plane rule's order; 1 as in the paper
  bool ask_always = false;  ///< not only where the cube's maps tell that the inside begins again behind the surface
  float cosine_c = 0.745F;  ///< of cone C's half-angle
};

struct Exit {
  glm::vec3 point{0.0F};
  glm::vec3 normal{0.0F};  ///< unit, outward
  float length = 0;        ///< of the way inside
  int steps = 0;
  int cube = 0;
  bool bounded = false;  ///< stopped by the bound: the point is the last surface point fetched
};

/// The share of the next step that cones A and B allow, at distance l from the centre along v inside d.
inline float allowed_step(const CubeSample& s, const glm::vec3& v, float l, const glm::vec3& h) {
  const float d = s.bounds.x, hv = glm::dot(h, v);
  const glm::vec3 n(s.plane);  // its length cancels
  // Cone A: apex S, base at O, so a = n = −v. Cone B: apex O, base in the tangent plane, a = v.
  const float a = d * cone_step(l / d, -hv, -hv, 1.0F, s.bounds.y);
  const float b = d * cone_step((d - l) / d, hv, glm::dot(h, n), glm::dot(v, n), s.bounds.z);
  const float step = std::max(a < kFar ? a : 0.0F, b < kFar ? b : 0.0F);
  return std::min(step, 2.0F * d);
}

/// The cube whose centre is nearest to the plane through p across the direction to the current centre, among those not
/// in `asked`; −1 when there is none (Sec. 2.3, Fig. 7a). p lies at distance l along the unit v from the current
/// centre.
template <class Maps>
int next_cube(const Maps& maps, const glm::vec3& v, float l, int current, std::uint32_t asked) {
  int best = -1;
  float least = kFar;
  for (int i = 0; i < maps.count(); ++i) {
    const float away = std::abs(glm::dot(maps.center(i) - maps.center(current), v) - l);
    if ((asked >> static_cast<unsigned>(i) & 1U) != 0U || away >= least) continue;
    least = away;
    best = i;
  }
  return best;
}

/// Step 4 of the paper's listing: how far the way from p, a surface point with the outward unit normal N, is known to
/// be clear. That is R_C where the ray lies in cone C, which it may not after total reflection; δ at least.
template <class Maps>
float first_step(const Maps& maps, const glm::vec3& p, const glm::vec3& normal, const glm::vec3& h, int cube,
                 const SearchOptions& options) {
  if (-glm::dot(h, normal) < options.cosine_c - 1e-4F) return options.min_step;
  return std::max(options.min_step, maps.fetch(cube, p - maps.center(cube)).bounds.w);
}

/// A point of the ray as a cube sees it: along the unit v from the cube's centre O, at distance l.
struct PlaceInCube {
  glm::vec3 v{0.0F};
  float l = 0;
};
template <class Maps>
PlaceInCube place_in_cube(const Maps& maps, int cube, const glm::vec3& point) {
  const glm::vec3 from_centre = point - maps.center(cube);
  const float l = std::max(glm::length(from_centre), 1e-20F);
  return {from_centre / l, l};
}

/// How far the march has come. The exit lies between `inside` and t if it was found.
struct March {
  float t = 0;
  float inside = 0;  ///< the last t known to lie inside
  int cube = 0;
  int steps = 0;
  bool found = false;   ///< t lies beyond the exit
  PlaceInCube outside;  ///< the first cube's view of the last point outside, and its sample there, which tells S and N
  CubeSample sample;
};

/// Sec. 2.2 and 2.3: steps of the length that cones A and B and sphere D allow, δ at least, until a point lies outside
/// for the cube, and for the others that the plane rule names in turn.
template <class Maps>
March march(const Maps& maps, const glm::vec3& p, const glm::vec3& h, int cube, float start,
            const SearchOptions& options) {
  March m;
  m.t = start;
  m.cube = cube;
  int home = cube, asks = 0;  // who had the point outside, and how many others were asked since
  std::uint32_t asked = 0;
  while (!m.found && (m.steps < options.iterations || asks > 0)) {
    const PlaceInCube at = place_in_cube(maps, m.cube, p + m.t * h);
    const float sphere = maps.sphere(m.cube);
    const CubeSample here = maps.fetch(m.cube, at.v);
    if (at.l < sphere || at.l < here.bounds.x) {
      if (m.steps < options.iterations) {
        const float allowed =
            at.l < sphere ? sphere * sphere_step(at.l / sphere, glm::dot(h, at.v)) : allowed_step(here, at.v, at.l, h);
        m.inside = m.t;
        m.t += std::max(allowed, options.min_step);
        ++m.steps;
      }
      home = m.cube;
      asks = 0;
      continue;
    }
    if (asks == 0) {
      ++m.steps;
      m.outside = at;
      m.sample = here;
      asked = 0;
    }
    // Outside for this cube: out of its sight, if the inside begins again behind the surface, or through it.
    asked |= 1U << static_cast<unsigned>(m.cube);
    const bool ask = asks < options.switches && (options.ask_always || m.sample.plane.w > 0.0F);
    const int other = ask ? next_cube(maps, m.outside.v, m.outside.l, home, asked) : -1;
    ++asks;
    if (other >= 0) {
      m.cube = other;
      continue;
    }
    m.cube = home;
    asks = 0;
    // A ray that heads inwards is only beneath the sampled surface, not through it.
    m.found = glm::dot(h, glm::vec3(m.sample.plane)) > 0.0F;
    if (!m.found) m.t += options.min_step;
  }
  return m;
}

/// The place along the ray where it meets the tangent plane through S = O + d·v with the normal N; or half-way between
/// `inside` and `outside`, where the plane leads out of that interval by more than rounding may.
inline float corrected(const glm::vec3& s, const glm::vec3& normal, const glm::vec3& p, const glm::vec3& h, float t,
                       float inside, float outside, float rounding) {
  const float slope = glm::dot(h, normal);
  const float next = slope > 1e-6F ? t + glm::dot(s - (p + t * h), normal) / slope : kFar;
  const bool near = next >= inside - rounding && next <= outside + rounding;
  return near ? std::clamp(next, inside, outside) : 0.5F * (inside + std::min(outside, t));
}

/// The unit normal where the ray leaves, by the mean of the texels' normals. That is short where they belong to two
/// faces of an edge; it is not known then which of the two the ray meets, and the more they disagree the straighter it
/// goes on: the mean alone might look against the ray, or make it graze, and the light would be lost inside.
inline glm::vec3 leaving_normal(const glm::vec3& mean, const glm::vec3& h) {
  return glm::normalize(mean + 4.0F * std::max(0.95F - glm::length(mean), 0.0F) * h);
}

/// Follows the ray p + t·h (h unit) from a surface point with outward unit normal `normal` through the inside, starting
/// in `cube`.
template <class Maps>
Exit find_exit(const Maps& maps, const glm::vec3& p, const glm::vec3& normal, const glm::vec3& h, int cube,
               const SearchOptions& options) {
  const March m = march(maps, p, h, cube, first_step(maps, p, normal, h, cube, options), options);
  float t = m.t, inside = m.inside, outside = m.found ? m.t : kFar;
  glm::vec3 v = m.outside.v;
  CubeSample sample = m.sample;
  const auto surface = [&] { return maps.center(m.cube) + sample.bounds.x * v; };  // S
  // Where the bound stopped the march, one fetch tells the surface point ahead.
  const int fetches = m.found ? options.refine : 1;
  for (int k = 0; k < fetches; ++k) {
    if (m.found) t = corrected(surface(), glm::vec3(sample.plane), p, h, t, inside, outside, 0.01F * options.min_step);
    const PlaceInCube at = place_in_cube(maps, m.cube, p + t * h);
    v = at.v;
    sample = maps.fetch(m.cube, v);
    (at.l < sample.bounds.x ? inside : outside) = t;
  }
  Exit exit;
  exit.point = m.found && options.refine > 0 ? p + t * h : surface();
  exit.normal = leaving_normal(glm::vec3(sample.plane), h);
  exit.length = t;
  exit.steps = m.steps;
  exit.cube = m.cube;
  exit.bounded = !m.found;
  return exit;
}

}  // namespace pellucid::geocube
