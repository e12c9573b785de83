#pragma once

#include <vector>

#include "algorithms/scene/images/image.hpp"

namespace pellucid::sweeps::testing {

/// FLIP as the papers state it (references.bib: andersson2020, andersson2021), the slow way: double precision, 2D
/// filters, YCxCz with its scales. It shares no code with the implementation under test.
std::vector<double> slow_ldr_flip(const Image& reference, const Image& test, double pixels_per_degree);
std::vector<double> slow_hdr_flip(const Image& reference, const Image& test, double pixels_per_degree,
                                  const std::vector<double>& exposures);

}  // namespace pellucid::sweeps::testing
