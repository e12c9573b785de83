#include "sweeps/store/rows.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/technique.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;

const json* find(const json& row, std::string_view field) {
  const auto found = row.find(field);
  return found == row.end() ? nullptr : &*found;
}

const ParameterTable* parameters_of(const std::string& technique) {
  for (const TechniqueInfo& info : techniques()) {
    if (info.name == technique) return &info.table();
  }
  return nullptr;
}

}  // namespace

std::optional<double> number(const json& row, std::string_view field) {
  const json* found = find(row, field);
  if (found == nullptr || !found->is_number()) return std::nullopt;
  const double value = found->get<double>();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::optional<double> number_or_flag(const json& row, std::string_view field) {
  const json* found = find(row, field);
  if (found != nullptr && found->is_boolean()) return found->get<bool>() ? 1.0 : 0.0;
  return number(row, field);
}

std::string text(const json& row, std::string_view field) {
  const json* found = find(row, field);
  return found != nullptr && found->is_string() ? found->get<std::string>() : std::string();
}

std::string value_text(const json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  return value.dump();
}

std::string field_text(const json& row, std::string_view field) {
  const json* found = find(row, field);
  return found == nullptr ? std::string() : value_text(*found);
}

std::string outcome(const json* row) {
  if (row == nullptr) return "missing";
  if (text(*row, "status") == "failed") return "failed";
  const std::string timing = text(*row, "timing");
  return timing == "converged" || timing == "unconverged" ? timing : "untimed";
}

bool meets(const json& row, const Condition& condition) {
  const json* found = find(row, condition.field);
  if (found == nullptr) return false;
  if (found->is_number()) {
    double wanted = 0;
    const char* const end = condition.value.data() + condition.value.size();
    const auto [stopped, error] = std::from_chars(condition.value.data(), end, wanted);
    return error == std::errc{} && stopped == end && found->get<double>() == wanted;
  }
  return value_text(*found) == condition.value;
}

SweepRows rows_of_sweep(const std::vector<json>& rows, const std::string& sweep) {
  for (const std::string& name : {sweep, sweep + "_preview"}) {
    SweepRows found{name, {}};
    for (const json& row : rows) {
      if (text(row, "sweep") == name) found.rows.push_back(&row);
    }
    if (!found.rows.empty()) return found;
  }
  return {};
}

std::string machine(const json& row) {
  const std::string device = text(row, "device");
  return device.empty() ? "" : fmt::format("{}, {}", device, text(row, "driver"));
}

std::set<std::string> machines(const RowPointers& rows) {
  std::set<std::string> found;
  for (const json* row : rows) {
    if (const std::string name = machine(*row); !name.empty()) found.insert(name);
  }
  return found;
}

std::set<std::string> distinct(const RowPointers& rows, std::string_view field) {
  std::set<std::string> values;
  for (const json* row : rows) {
    if (const std::string value = text(*row, field); !value.empty()) values.insert(value);
  }
  return values;
}

std::optional<std::pair<double, double>> extent(const RowPointers& rows, std::string_view field) {
  std::optional<std::pair<double, double>> result;
  for (const json* row : rows) {
    const auto value = number(*row, field);
    if (!value) continue;
    if (!result) result = {*value, *value};
    result->first = std::min(result->first, *value);
    result->second = std::max(result->second, *value);
  }
  return result;
}

std::string reference_exactness(const RowPointers& rows) {
  const auto words = [&](const char* kind, bool zero_too) -> std::string {
    const auto most = extent(rows, fmt::format("reference_{}_error_max", kind));
    const auto mean = extent(rows, fmt::format("reference_{}_error_mean", kind));
    if (!most || !mean || (most->second == 0 && !zero_too)) return "";
    return fmt::format("{} error is at most {}, {} in the mean", kind, significant(most->second, 2),
                       significant(mean->second, 2));
  };
  // The standard error is 0 with one ray a pixel; a reference without a medium takes no steps.
  const std::string noise = words("standard", false), steps = words("step", noise.empty());
  return noise + (noise.empty() || steps.empty() ? "" : "; its ") + steps;
}

std::vector<std::pair<std::string, std::string>> settings(const json& row) {
  std::vector<std::pair<std::string, std::string>> result;
  const std::string technique = field_text(row, "technique");
  result.emplace_back("technique", technique);
  for (const char* field : {"scene", "view"}) {
    if (row.contains(field)) result.emplace_back(field, field_text(row, field));
  }
  if (row.contains("width") && row.contains("height"))
    result.emplace_back("size", fmt::format("{}×{}", field_text(row, "width"), field_text(row, "height")));
  const ParameterTable* table = parameters_of(technique);
  for (const auto& [name, value] : row.items()) {
    const bool parameter = name.find('.') != std::string::npos || (table != nullptr && table->find(name) != nullptr);
    if (parameter) result.emplace_back(name, value_text(value));
  }
  return result;
}

std::string difference(const json& a, const json& b) {
  for (const char* field : {"scene", "view", "width", "height", "block"}) {
    if (a.contains(field) && b.contains(field) && a.at(field) != b.at(field))
      return fmt::format("{} is {} in one and {} in the other", field, a.at(field).dump(), b.at(field).dump());
  }
  return fmt::format("points {} and {}", text(a, "point"), text(b, "point"));
}

std::string significant(double value, int digits) {
  if (value == 0) return "0";
  const double magnitude = std::floor(std::log10(std::abs(value)));
  if (magnitude < -4 || magnitude >= 7) return fmt::format("{:.{}e}", value, digits - 1);
  return fmt::format("{:.{}f}", value, std::max(0, digits - 1 - static_cast<int>(magnitude)));
}

}  // namespace pellucid::sweeps
