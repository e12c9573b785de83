#pragma once

#include <string>
#include <vector>

#include "algorithms/scattering/slab.hpp"
#include "plots/charts/chart.hpp"

namespace pellucid::plots {

/// How slabs of one medium and several optical thicknesses spread a beam: worked out (algorithms/scattering/slab.hpp),
/// not measured, so that it needs no rows.
struct SlabChart {
  enum class Show { transmission, reflection };
  Show show = Show::transmission;
  scattering::SlabMedium medium;
  std::vector<double> depths;  ///< a line each
  bool polar = false;          ///< the radiance as a distance in the direction of the light, the slab's normal upwards
  std::string title{};
};

inline constexpr int kSlabOrdinates = 128;  ///< angles in a hemisphere, for smooth lines
Chart chart_of_slabs(const SlabChart&);

}  // namespace pellucid::plots
