#include "sweeps/store/select.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/parameters.hpp"
#include "gl/error.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;
using Compare = RowCondition::Compare;

std::optional<double> number_in(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

template <class T>
bool compares(const T& a, Compare compare, const T& b) {
  switch (compare) {
    case Compare::equal:
      return a == b;
    case Compare::unequal:
      return a != b;
    case Compare::less:
      return a < b;
    case Compare::at_most:
      return a <= b;
    case Compare::more:
      return a > b;
    case Compare::at_least:
      break;
  }
  return a >= b;
}

bool meets(const json& row, const RowCondition& condition) {
  const auto found = row.find(condition.field);
  if (found == row.end() || found->is_null()) return condition.compare == Compare::unequal;
  if (const auto wanted = number_in(condition.value); wanted && found->is_number())
    return compares(found->get<double>(), condition.compare, *wanted);
  const std::string text = found->is_string() ? found->get<std::string>() : found->dump();
  return compares(text, condition.compare, condition.value);
}

void check_field(const std::string& field, const std::vector<std::string>& names) {
  if (std::binary_search(names.begin(), names.end(), field)) return;
  const std::string near = nearest_name(field, names);
  throw InputError(near.empty() ? fmt::format("no row has a field '{}'; there are {}", field, fmt::join(names, ", "))
                                : fmt::format("no row has a field '{}'; did you mean '{}'?", field, near));
}

/// A text never meets a condition on numbers; asked for by mistake, it would look as if there were no such rows.
void check_value(const RowCondition& condition, const std::vector<json>& flat_rows) {
  if (const auto wanted = number_in(condition.value); wanted && std::isfinite(*wanted)) return;
  bool any = false;
  for (const json& row : flat_rows) {
    const auto found = row.find(condition.field);
    if (found == row.end() || found->is_null()) continue;
    if (!found->is_number()) return;
    any = true;
  }
  if (any)
    throw InputError(fmt::format("'{}' holds numbers; '{}' is no finite number", condition.field, condition.value));
}

}  // namespace

RowCondition parse_row_condition(const std::string& text) {
  // The longer first, so that "<=" is not read as "<".
  constexpr std::array<std::pair<std::string_view, Compare>, 6> kCompares{{{"!=", Compare::unequal},
                                                                           {"<=", Compare::at_most},
                                                                           {">=", Compare::at_least},
                                                                           {"<", Compare::less},
                                                                           {">", Compare::more},
                                                                           {"=", Compare::equal}}};
  const std::size_t at = text.find_first_of("!<>=");
  for (const auto& [sign, compare] : kCompares) {
    if (at == std::string::npos || at == 0 || text.compare(at, sign.size(), sign) != 0) continue;
    return {text.substr(0, at), text.substr(at + sign.size()), compare};
  }
  throw InputError(
      fmt::format("condition '{}' is not field=value, nor with !=, <, <=, > or >=, for example hulls>=4", text));
}

json opened(const json& row) {
  json flat = json::object();
  for (const auto& [name, value] : row.items()) {
    if (!value.is_object()) {
      flat[name] = value;
      continue;
    }
    for (const auto& [inner, inner_value] : value.items())
      flat[name + "." + inner] = inner_value;
  }
  return flat;
}

std::vector<std::string> field_names(const std::vector<json>& rows) {
  std::set<std::string> names;
  for (const json& row : rows) {
    const json flat = opened(row);
    for (const auto& [name, value] : flat.items())
      names.insert(name);
  }
  return {names.begin(), names.end()};
}

std::vector<json> select_rows(const std::vector<json>& rows, const std::vector<RowCondition>& conditions) {
  if (conditions.empty() || rows.empty()) return rows;
  const std::vector<std::string> names = field_names(rows);
  std::vector<json> flat;
  std::transform(rows.begin(), rows.end(), std::back_inserter(flat), opened);
  for (const RowCondition& condition : conditions) {
    check_field(condition.field, names);
    check_value(condition, flat);
  }
  std::vector<json> result;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (std::all_of(conditions.begin(), conditions.end(), [&](const auto& c) { return meets(flat[i], c); }))
      result.push_back(rows[i]);
  }
  return result;
}

std::vector<nlohmann::ordered_json> select_fields(const std::vector<json>& rows,
                                                  const std::vector<std::string>& fields) {
  const std::vector<std::string> names = field_names(rows);
  for (const std::string& field : fields) {
    if (!rows.empty()) check_field(field, names);
  }
  std::vector<nlohmann::ordered_json> result;
  for (const json& row : rows) {
    const json flat = opened(row);
    nlohmann::ordered_json chosen = nlohmann::ordered_json::object();
    for (const std::string& field : fields)
      chosen[field] = flat.contains(field) ? nlohmann::ordered_json(flat.at(field)) : nlohmann::ordered_json();
    result.push_back(std::move(chosen));
  }
  return result;
}

}  // namespace pellucid::sweeps
