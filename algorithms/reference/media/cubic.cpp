#include "algorithms/reference/media/cubic.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pellucid {

int monotone_parts(const Cubic& c, double (&ends)[4]) {
  int count = 0;
  ends[count++] = 0.0;
  // c1 + 2 c2 s + 3 c3 s² = 0, without the cancellation of the schoolbook formula.
  const double square = c[2] * c[2] - 3.0 * c[1] * c[3];
  if (square > 0.0) {
    const double q = -(c[2] + std::copysign(std::sqrt(square), c[2]));
    double a = q / (3.0 * c[3]), b = c[1] / q;
    if (a > b) std::swap(a, b);
    for (const double s : {a, b}) {
      if (s > 0.0 && s < 1.0) ends[count++] = s;  // not if it is infinite or NaN
    }
  }
  ends[count++] = 1.0;
  return count;
}

double solve_monotone(const Cubic& c, double wanted, double low, double high) {
  const bool rising = value(c, high) > value(c, low);
  double s = 0.5 * (low + high);
  // Newton's step where it stays inside the bracket, else halving.
  for (int i = 0; i < 100; ++i) {
    const double excess = value(c, s) - wanted;
    if (excess == 0.0) break;
    ((excess < 0.0) == rising ? low : high) = s;
    const double slope = c[1] + s * (2.0 * c[2] + s * 3.0 * c[3]);
    double next = s - excess / slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (next == s || next == low || next == high || std::abs(next - s) < 1e-16) break;
    s = next;
  }
  return s;
}

}  // namespace pellucid
