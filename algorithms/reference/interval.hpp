#pragma once

namespace pellucid {

/// Part of a ray, as distances from its origin; empty when end ≤ begin.
struct Interval {
  double begin = 0;
  double end = 0;
};

}  // namespace pellucid
