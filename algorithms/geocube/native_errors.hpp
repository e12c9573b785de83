#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "algorithms/geocube/solid.hpp"

namespace pellucid::geocube {

/// What a pixel's first search found, in the object's space; four floats a pixel each.
struct SearchReport {
  std::vector<float> entry;        ///< point; 1 where the pixel shows the object and light enters
  std::vector<float> ray;          ///< unit direction inside; steps
  std::vector<float> exit_point;   ///< point; length, negative where the bound stopped the search
  std::vector<float> exit_normal;  ///< unit; last cube
};

/// One object's searches beside the true surface (Embree); lengths are shares of the object's diagonal.
class SearchErrors {
 public:
  /// `ior` of the material, for the directions of the light that leaves.
  void add(const SearchReport&, const Solid&, double ior);
  /// `exit_error_mean`, `_median`, `_q95`, `_max`; `length_error_mean` …; `exit_direction_error_deg_mean` … of the rays
  /// that leave in both; `early_share`: of the rays that end more than 1 % of the diagonal before the surface;
  /// `bounded_share`: stopped by the bound; `steps_mean`, `steps_max`; `object_pixels`.
  void write(nlohmann::json& out);

 private:
  std::vector<double> exit_, length_, direction_deg_;
  std::size_t early_ = 0, bounded_ = 0;
  double steps_ = 0, most_steps_ = 0;
};

}  // namespace pellucid::geocube
