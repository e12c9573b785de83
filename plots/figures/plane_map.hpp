#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "plots/charts/chart.hpp"
#include "plots/figures/row_chart.hpp"
#include "plots/figures/rows.hpp"

namespace pellucid::plots {

/// A cell to point out: the one at a place of the plane, or the best one no worse than another mark's.
struct PlaneMark {
  std::string label;                                 ///< a word, below the number
  std::vector<std::pair<std::string, double>> at{};  ///< field and value; empty: chosen as follows
  std::string best{};                                ///< this quantity decides
  std::string no_worse_in{},
      than{};  ///< among the cells that are in this quantity no worse than the mark of that label
  /// A sentence for the small print. {FIELD} is the cell's value, {bound} that which the cell must not be worse than.
  std::string note{};
};

/// A quantity on the plane of two settings.
struct PlaneMap {
  AxisWish x{}, y{}, value{};
  std::vector<PlaneMark> marks{};
  std::vector<std::string> needs{};  ///< what a row must have besides
  std::vector<Where> where{};
  std::string title{};
};

/// A mark whose cell is missing is left out, and so is one that depends on it or on a quantity that a row lacks. Throws
/// InputError when the rows have more than one setting beside the two of the plane.
HeatMap map_of_rows(const std::vector<nlohmann::json>& rows, const PlaneMap&, const Fields& = Fields());

}  // namespace pellucid::plots
