#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

/// Reading the rows of a store (read_rows in store.hpp): the one way in which tables, charts, reports and the window
/// look at them.
namespace pellucid::sweeps {

using RowPointers = std::vector<const nlohmann::json*>;

/// A finite number; nothing when the field is absent, null or of another type.
std::optional<double> number(const nlohmann::json& row, std::string_view field);
/// The same, and a boolean as 0 or 1.
std::optional<double> number_or_flag(const nlohmann::json& row, std::string_view field);
/// A field that is text; empty when it is missing or of another type.
std::string text(const nlohmann::json& row, std::string_view field);
/// "0.5", "true", "fog_forest"
std::string value_text(const nlohmann::json& value);
/// The same of a field; empty when it is missing.
std::string field_text(const nlohmann::json& row, std::string_view field);

/// "converged", "unconverged", "untimed", "failed", or "missing" for no row.
std::string outcome(const nlohmann::json* row);

/// name=value, compared as text, numbers by value.
struct Condition {
  std::string field, value;
};
bool meets(const nlohmann::json& row, const Condition&);

/// Rows of a sweep or, when there are none, of its preview; `sweep` is the name of which. Empty when there are neither.
struct SweepRows {
  std::string sweep;
  RowPointers rows;
};
SweepRows rows_of_sweep(const std::vector<nlohmann::json>& rows, const std::string& sweep);

/// "DEVICE, DRIVER", as errors and notes call the machine of a row; empty for a point that failed before its worker
/// said hello.
std::string machine(const nlohmann::json& row);
std::set<std::string> machines(const RowPointers&);

/// The values of a text field, each once, sorted.
std::set<std::string> distinct(const RowPointers&, std::string_view field);
/// Smallest and largest of a field.
std::optional<std::pair<double, double>> extent(const RowPointers&, std::string_view field);

/// How exact the reference of these rows is, at worst: "step error is at most 0.00031, 1.2e-06 in the mean", the
/// standard error of one whose rays are random, or both, joined by "; its ". Empty where the rows tell neither.
std::string reference_exactness(const RowPointers&);

/// The choices for a point, as against its measurements: technique, scene, view, size ("720×540") and every parameter.
std::vector<std::pair<std::string, std::string>> settings(const nlohmann::json& row);

/// The difference between two rows, for the message that refuses to pool them: "view is 'a' in one and 'b' in the
/// other".
std::string difference(const nlohmann::json& a, const nlohmann::json& b);

/// So many significant digits, without an exponent between 1e-4 and 1e7.
std::string significant(double value, int digits);

}  // namespace pellucid::sweeps
