#pragma once

#include <vector>

#include "algorithms/scene/relief/patterns.hpp"
#include "algorithms/scene/relief/rain.hpp"

namespace pellucid {

/// The recipe of a moving layer's heights, so that a technique can make them again on the GPU.
struct ReliefMotion {
  // Waves: 1/2 plus the sum of these at the time.
  std::vector<Sine> sines;
  double time_s = 0;
  // Rain, where there are no waves.
  RainOptions rain;
  int steps = 0;
  Image ground_m;  ///< of the solid under the drops
  float below_m = 0, top_m = 0, height_m = 0;
};

}  // namespace pellucid
