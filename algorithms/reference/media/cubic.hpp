#pragma once

#include <vector>

#include <glm/glm.hpp>

namespace pellucid {

/// Σ c[i] sⁱ.
using Cubic = glm::dvec4;

inline double value(const Cubic& c, double s) {
  return c[0] + s * (c[1] + s * (c[2] + s * c[3]));
}

/// The cubic over [from, to] as one over [0, 1].
inline Cubic stretched(const Cubic& c, double from, double to) {
  const double h = to - from;
  return {value(c, from), h * (c[1] + from * (2 * c[2] + from * 3 * c[3])), h * h * (c[2] + 3 * from * c[3]),
          h * h * h * c[3]};
}

/// The ends of the parts of [0, 1] on which the cubic rises or falls: 0, its extrema inside, and 1. Returns their
/// number.
int monotone_parts(const Cubic& c, double (&ends)[4]);

/// The s in [low, high] where the cubic, which rises or falls there, takes the value `wanted`, which lies between its
/// values at both ends.
double solve_monotone(const Cubic& c, double wanted, double low, double high);

}  // namespace pellucid
