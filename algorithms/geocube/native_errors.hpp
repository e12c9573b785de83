#pragma once

#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "algorithms/geocube/solid.hpp"
#include "algorithms/technique.hpp"

namespace pellucid::geocube {

/// The result of a pixel's first search, in the object's space; four floats per pixel each, rows from the bottom.
struct SearchReport {
  std::vector<float> entry;        ///< point; 1 where the pixel shows the object and light enters
  std::vector<float> ray;          ///< unit direction inside; steps
  std::vector<float> exit_point;   ///< point; length, negative where the bound stopped the search
  std::vector<float> exit_normal;  ///< unit; last cube
};

/// The searches of a frame beside the true surface (Embree), by pixel; lengths are shares of the object's diagonal.
class SearchErrors {
 public:
  SearchErrors(int width, int height);
  /// One object's pixels. `ior` of the material, for the directions of the light that leaves.
  void add(const SearchReport&, const Solid&, double ior);
  /// `exit_error_mean`, `_median`, `_q95`, `_max`; `length_error_mean` …; `exit_direction_error_deg_mean` … of the rays
  /// that leave in both; `steps_mean` …; `early_share`: of the rays that end more than 1 % of the diagonal before the
  /// surface; `bounded_share`: stopped by the bound; `object_pixels`.
  void write(nlohmann::json& out) const;
  /// The same by pixel: `exit_error`, `length_error`, `exit_direction_error_deg`, `steps`, `early`, `bounded`.
  std::vector<NativeMap> maps() && { return std::move(maps_); }

 private:
  std::vector<NativeMap> maps_;
};

}  // namespace pellucid::geocube
