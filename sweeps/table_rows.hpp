#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "sweeps/tables.hpp"

/// What every table does with the rows of a store before it fills its own places. For the tables' own files.
namespace pellucid::sweeps {

/// The rows that a table may use: of one sweep, one device and one driver, each measurement once.
struct ChosenRows {
  std::string sweep;  ///< the table's spec or its preview; empty without rows
  std::vector<const nlohmann::json*> rows;
};

/// See make_table.
ChosenRows choose_rows(const TableInfo&, const std::vector<nlohmann::json>& rows, std::string_view device);

/// The row with these whole-number parameters, or null. Throws InputError when two claim the place.
const nlohmann::json* find_row(const ChosenRows&, std::string_view technique,
                               const std::vector<std::pair<std::string, std::int64_t>>& parameters);

/// A field that is a finite number.
std::optional<double> number(const nlohmann::json& row, const char* field);
/// A field that is text; empty when it is missing.
std::string text(const nlohmann::json& row, const char* field);
/// "converged", "unconverged", "untimed", "failed", or "missing" for no row.
std::string outcome(const nlohmann::json* row);

/// So many significant digits, without an exponent between 1e-4 and 1e7.
std::string significant(double value, int digits);

/// Where the used rows come from: device, driver, size, clock, scene and what stands in, frames, commit, drift.
std::vector<std::string> provenance_notes(const TableInfo&, const ChosenRows&);

/// Published numbers of Imagire et al. 2007, Table 1, beside ours.
TableInfo sampling_hulls_table1_info();
Table sampling_hulls_table1(const TableInfo&, const ChosenRows&);

}  // namespace pellucid::sweeps
