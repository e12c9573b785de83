#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "plots/charts/chart.hpp"
#include "plots/figures/rows.hpp"

namespace pellucid::plots {

/// A chart of any two fields of a store's rows.
struct RowChart {
  std::string x{};                    ///< empty: the parameter that takes the most values
  std::string y{};                    ///< empty: fps where there is one, else flip_mean, else rmse
  std::vector<std::string> series{};  ///< settings that divide the rows into lines; empty: all that vary
  bool log_x = false, log_y = false;
  std::vector<Condition> conditions{};
  std::string title{};  ///< empty: "y over x"
};

/// Throws InputError for unknown fields (nearest name), rows of several devices, and for several rows at one x of one
/// line, which are never averaged: the message says in which settings they differ.
Chart chart_of_rows(const std::vector<nlohmann::json>& rows, const RowChart&);

}  // namespace pellucid::plots
