#pragma once

#include <vector>

#include "algorithms/scene/images/image.hpp"

/// Maps of values in colours. Not-a-numbers are pixels without a value.
namespace pellucid::plots {

/// Where the colours of some maps of one channel end: the round number (1, 2 or 5 times a power of ten) at or above 99
/// % of each one's values, or 1 where those are all 0. The few beyond are shown as the end.
double color_range(const std::vector<const Image*>& maps);

/// Black for 0 to pale yellow for `range` and above, as FLIP's error maps have it (sweeps/metrics/flip.hpp), and grey
/// without a value.
Image false_colors(const Image& map, double range);

}  // namespace pellucid::plots
