#include "sweeps/tables/csv.hpp"

#include <algorithm>
#include <set>

#include <nlohmann/json.hpp>

#include "sweeps/quantities/quantities.hpp"
#include "sweeps/store/select.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;
using ColumnNames = std::vector<std::string>;

std::string field(const json& row, const std::string& name) {
  const auto found = row.find(name);
  if (found == row.end() || found->is_null()) return "";
  if (found->is_string()) return found->get<std::string>();
  return found->dump(-1, ' ', false, json::error_handler_t::replace);
}

/// The columns of `rows`, which are opened: identity, then what nobody declares for all rows (parameters and native
/// errors), then the rest as it is declared. An object's members (`pass_ms.fog`) stand where the object is declared.
ColumnNames columns(const std::vector<json>& rows) {
  std::set<std::string> present;
  for (const json& row : rows) {
    for (const auto& [name, value] : row.items())
      present.insert(name);
  }
  ColumnNames result, measured;
  for (const Quantity& quantity : quantities()) {
    if (!quantity.module.empty()) continue;
    if (quantity.identity) {
      result.push_back(quantity.name);
      present.erase(quantity.name);
      continue;
    }
    if (present.erase(quantity.name) > 0) measured.push_back(quantity.name);
    const std::string members = quantity.name + '.';
    const auto first = present.lower_bound(members);
    const auto last = std::find_if_not(first, present.end(), [&](const auto& n) { return n.starts_with(members); });
    measured.insert(measured.end(), first, last);
    present.erase(first, last);
  }
  result.insert(result.end(), present.begin(), present.end());
  result.insert(result.end(), measured.begin(), measured.end());
  return result;
}

}  // namespace

std::string csv_record(const ColumnNames& fields) {
  std::string out;
  for (const std::string& text : fields) {
    if (&text != &fields.front()) out += ',';
    if (text.find_first_of(",\"\r\n") == std::string::npos) {
      out += text;
      continue;
    }
    out += '"';
    for (const char c : text) {
      if (c == '"') out += '"';
      out += c;
    }
    out += '"';
  }
  return out + "\r\n";
}

namespace {

std::string table(const std::vector<json>& flat, const ColumnNames& names) {
  std::string out = csv_record(names);
  ColumnNames fields(names.size());
  for (const json& row : flat) {
    std::transform(names.begin(), names.end(), fields.begin(), [&](const std::string& n) { return field(row, n); });
    out += csv_record(fields);
  }
  return out;
}

std::vector<json> all_opened(const std::vector<json>& rows) {
  std::vector<json> flat;
  flat.reserve(rows.size());
  for (const json& row : rows)
    flat.push_back(opened(row));
  return flat;
}

}  // namespace

std::string rows_to_csv(const std::vector<json>& rows) {
  const std::vector<json> flat = all_opened(rows);
  return table(flat, columns(flat));
}

std::string rows_to_csv(const std::vector<json>& rows, const ColumnNames& names) {
  return table(all_opened(rows), names);
}

}  // namespace pellucid::sweeps
