#pragma once

#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>

/// Where a ray meets the environment that a distance impostor stores (Szirmay-Kalos et al. 2005, Sec. 2,
/// references.bib: szirmaykalos2005). GLSL twin: hit_search.glsl.
namespace pellucid::local_cube_maps {

enum class Scheme {
  secant,                ///< Eq. 6 on the last two points
  false_position,        ///< Eq. 6 on the last point and the last one of the other kind
  linear,                ///< beyond the paper: the first crossing among equal steps of angle, then bisected
  linear_false_position  ///< the same with few steps, then Eq. 6 within the crossing
};

struct HitSearch {
  int iterations = 2;  ///< NITER; −1 ends with p, 0 with l. For the linear scheme: bisections
  Scheme scheme = Scheme::false_position;
  int steps = 64;  ///< of the linear schemes
};

/// Distances that a search fetches at most: r, that of p, and one for each l; of the linear schemes one a step, and one
/// a bisection or iteration, with r where no step lies beyond the surface.
inline int fetches(const HitSearch& search) {
  const int refined = std::max(search.iterations, 0);
  if (search.scheme == Scheme::linear) return search.steps + refined;
  if (search.scheme == Scheme::linear_false_position) return search.steps + refined + 1;
  return search.iterations < 0 ? 1 : 2 + search.iterations;
}

/// The least denominator of Eq. 6: two points that are equally far off determine no line.
inline constexpr double kLeastDifference = 1e-7;

namespace detail {

// Along the ray the direction from o turns from x to R by the angle θ between them. A point at the angle φ from x lies
// |x| sin θ / sin(θ − φ) from o (law of sines), so that equal steps of φ are equal steps over the map.
template <class Real>
struct Turn {
  using Vec = glm::vec<3, Real>;
  Vec from{0}, across{0};
  Real theta = 0, height = 0;  // height: |x| sin θ
  bool none = false;           // the ray runs along one direction

  Turn(const Vec& x, const Vec& R) {
    const Real r = glm::length(x);
    none = r < Real(1e-6);
    if (none) return;
    from = x / r;
    const Real cosine = std::clamp(glm::dot(from, R), Real(-1), Real(1));
    across = R - cosine * from;
    const Real sine = glm::length(across);
    none = sine < Real(1e-4) && cosine > 0;
    if (none) return;
    // Straight through o no direction lies between: take a plane beside it.
    if (sine < Real(1e-4)) across = glm::cross(from, std::abs(from.x) < Real(0.7) ? Vec(1, 0, 0) : Vec(0, 1, 0));
    across = glm::normalize(across);
    theta = std::min(std::atan2(sine, cosine), Real(3.1405927));
    height = r * std::sin(theta);
  }
  Vec direction(Real phi) const { return std::cos(phi) * from + std::sin(phi) * across; }
};

template <class Real, class Distance>
glm::vec<3, Real> find_linear(const glm::vec<3, Real>& x, const glm::vec<3, Real>& R, const Distance& distance,
                              const HitSearch& search) {
  const Turn<Real> turn(x, R);
  if (turn.none) return R * std::max(distance(R), glm::length(x));
  const auto over = [&](Real phi) { return turn.height >= distance(turn.direction(phi)) * std::sin(turn.theta - phi); };
  Real low = 0, high = turn.theta;
  bool under = false, found = false;
  for (int i = 0; i < search.steps && !found; ++i) {
    const Real phi = turn.theta * static_cast<Real>(i) / static_cast<Real>(search.steps);
    const bool beyond = over(phi);
    if (beyond && under) {
      high = phi;
      found = true;
    } else {
      // The ray may set out behind the surface, or on it.
      low = phi;
      under = !beyond;
    }
  }
  if (!found && !under) return R * distance(R);
  for (int i = 0; i < search.iterations; ++i) {
    const Real middle = Real(0.5) * (low + high);
    (over(middle) ? high : low) = middle;
  }
  const Real phi = Real(0.5) * (low + high);
  return turn.direction(phi) * (turn.height / std::max(std::sin(turn.theta - phi), Real(1e-6)));
}

// Eq. 6 with an undershooting point and an overshooting one; without the latter the point at infinity stands in.
template <class Real, class Distance>
glm::vec<3, Real> find_within_steps(const glm::vec<3, Real>& x, const glm::vec<3, Real>& R, const Distance& distance,
                                    const HitSearch& search) {
  const Turn<Real> turn(x, R);
  if (turn.none) return R * std::max(distance(R), glm::length(x));
  Real dun = 0, dov = 0, pun = 0, pov = 0;
  bool under = false, found = false;
  for (int i = 0; i < search.steps && !found; ++i) {
    const Real phi = turn.theta * static_cast<Real>(i) / static_cast<Real>(search.steps);
    const Real away = std::sin(turn.theta - phi);
    const Real d = glm::length(x) * std::sin(phi) / away, llp = turn.height / (away * distance(turn.direction(phi)));
    if (llp >= 1 && under) {
      dov = d;
      pov = llp;
      found = true;
    } else {
      dun = d;
      pun = llp;
      under = llp < 1;
    }
  }
  const Real r = distance(R);
  if (!under) return R * r;
  const auto next = [&] { return found ? dun + (dov - dun) * (1 - pun) / (pov - pun) : dun + r * (1 - pun); };
  Real dl = next();
  for (int i = 0; i < search.iterations; ++i) {
    const glm::vec<3, Real> l = x + R * dl;
    const Real llp = glm::length(l) / distance(l);
    if (llp < 1) {
      dun = dl;
      pun = llp;
    } else {
      dov = dl;
      pov = llp;
      found = true;
    }
    dl = next();
  }
  return x + R * dl;
}

}  // namespace detail

/// The approximate hit l of the ray x + R·d, d ≥ 0. The origin is the reference point o, `R` is unit, and
/// `distance(direction)` is how far the surface lies from o in a direction of any length, > 0.
template <class Real, class Distance>
glm::vec<3, Real> find_hit(const glm::vec<3, Real>& x, const glm::vec<3, Real>& R, const Distance& distance,
                           const HitSearch& search) {
  using Vec = glm::vec<3, Real>;
  if (search.scheme == Scheme::linear) return detail::find_linear(x, R, distance, search);
  if (search.scheme == Scheme::linear_false_position) return detail::find_within_steps(x, R, distance, search);

  // p, as if the surface stood across R at r: d_p = |r| − R·x. `ppp` is |p| / |p'|.
  const Real r = distance(R);
  Real dp = std::max(r - glm::dot(x, R), Real(0));
  const Vec p = x + R * dp;
  if (search.iterations < 0) return p;
  Real ppp = glm::length(p) / distance(p);

  // Eq. 4: l, where the line through r and p' meets the ray.
  Real dl = std::max(dp + r * (1 - ppp), Real(0));
  Vec l = x + R * dl;

  // The last undershooting and overshooting points; 0: none yet, the point at infinity in the direction R stands in.
  Real dun = 0, dov = 0, pun = ppp, pov = ppp;
  (ppp < 1 ? dun : dov) = dp;
  for (int i = 0; i < search.iterations; ++i) {
    const Real llp = glm::length(l) / distance(l);
    Real step = 0;
    if (search.scheme == Scheme::secant) {
      // Eq. 6 with p and l, whatever their kinds.
      const Real difference = llp - ppp;
      if (std::abs(difference) > Real(kLeastDifference)) step = (dl - dp) * (1 - llp) / difference;
      dp = dl;
      ppp = llp;
    } else if (llp < 1) {
      dun = dl;
      pun = llp;
      step = dov == 0 ? r * (1 - llp) : (dl - dov) * (1 - llp) / (llp - pov);
    } else {
      dov = dl;
      pov = llp;
      step = dun == 0 ? r * (1 - llp) : (dl - dun) * (1 - llp) / (llp - pun);
    }
    dl = std::max(dl + step, Real(0));  // the ray must not flip
    l = x + R * dl;
  }
  return l;
}

}  // namespace pellucid::local_cube_maps
