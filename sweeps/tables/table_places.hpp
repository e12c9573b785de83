#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "sweeps/tables/table_rows.hpp"

/// Rows of a table whose columns are points of a sweep. For the tables' own files.
namespace pellucid::sweeps {

/// A column, and the row of the store that fills it.
struct Place {
  std::string name;                     ///< in notes: "4 × 8"
  const nlohmann::json* row = nullptr;  ///< null: not measured
  std::string outcome;                  ///< see outcome()

  bool measured() const { return row != nullptr && outcome != "failed"; }
};
Place make_place(std::string name, const nlohmann::json* row);

using PlaceValue = std::function<std::optional<double>(const nlohmann::json&)>;

/// One row of ours: `value` where the point was measured, "failed" where it failed.
TableRow our_row(std::string label, std::span<const Place>, int digits, const PlaceValue& value,
                 unsigned in = TableRow::all);
/// The same with values that are worked out already, one for each place.
TableRow value_row(std::string label, std::span<const Place>, int decimals,
                   const std::vector<std::optional<double>>& values);
/// Words alone: a heading.
TableRow words_row(std::string label, const std::vector<std::string>& words);
/// Published numbers, or nothing where the paper has none.
TableRow paper_row(std::string label, int decimals, const std::vector<std::optional<double>>& values);

/// Frames a second, with a dagger where the time did not converge.
TableRow fps_row(std::string label, std::span<const Place>);
std::optional<double> fps(const Place&);
/// A bound of the median's interval as frames a second: the frame's longest time is its lowest rate.
std::optional<double> fps_bound(const nlohmann::json& row, const char* frame_ms);
/// The interval of the frame rate: one row for a page, two for programs.
std::vector<TableRow> interval_rows(std::span<const Place>);

/// "converged", … of every place, for CSV.
TableRow outcome_row(std::span<const Place>);
/// What is unconverged, failed, untimed or missing; `untimed` for tables that show times.
std::vector<std::string> outcome_notes(std::span<const Place>, bool untimed = true);

/// A measured field of a place, for JSON.
std::optional<Value> real_field(const Place&, const char* name);
std::optional<Value> real_value(std::optional<double>);
/// `outcome`, `failure`, `frames`, scene, view, size, device, driver, clock, commit and `sweep`, appended.
void add_origin(TableRecord&, const Place&, const std::string& sweep);

}  // namespace pellucid::sweeps
