#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

/// Choosing among the rows of a store and among their fields.
namespace pellucid::sweeps {

/// "hulls>=4": a field, one of = != < <= > >=, and a value. Numbers compare as numbers, all else as text.
struct RowCondition {
  enum class Compare { equal, unequal, less, at_most, more, at_least };
  std::string field, value;
  Compare compare = Compare::equal;
};
/// Throws InputError.
RowCondition parse_row_condition(const std::string&);

/// The rows that meet all conditions. A row without the field meets none but `!=`. Throws InputError, with the nearest
/// name, when no row has a field of that name, and when a field of numbers is compared with something else.
std::vector<nlohmann::json> select_rows(const std::vector<nlohmann::json>& rows, const std::vector<RowCondition>&);

/// Every name of a field, an object's members opened (`pass_ms.fog`), sorted.
std::vector<std::string> field_names(const std::vector<nlohmann::json>& rows);

/// The rows with these fields alone, null where a row lacks one. Throws InputError as above.
std::vector<nlohmann::ordered_json> select_fields(const std::vector<nlohmann::json>& rows,
                                                  const std::vector<std::string>& fields);

/// A row with its objects opened.
nlohmann::json opened(const nlohmann::json& row);

}  // namespace pellucid::sweeps
