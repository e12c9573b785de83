#include "plots/rows.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/technique.hpp"
#include "gl/error.hpp"
#include "plots/style.hpp"

namespace pellucid::plots {
namespace {

using nlohmann::json;

std::string text_of(const json& row, std::string_view field) {
  const auto found = row.find(std::string(field));
  return found == row.end() ? std::string() : value_text(*found);
}

bool meets(const json& row, const Condition& condition) {
  const auto found = row.find(condition.field);
  if (found == row.end()) return false;
  if (found->is_number()) {
    double wanted = 0;
    const char* const end = condition.value.data() + condition.value.size();
    const auto [stopped, error] = std::from_chars(condition.value.data(), end, wanted);
    return error == std::errc{} && stopped == end && found->get<double>() == wanted;
  }
  return value_text(*found) == condition.value;
}

void check_field(const std::vector<json>& rows, const std::string& field) {
  std::set<std::string> names;
  for (const json& row : rows) {
    for (const auto& [name, value] : row.items()) {
      if (name == field) return;
      names.insert(name);
    }
  }
  const std::vector<std::string> candidates(names.begin(), names.end());
  const std::string near = nearest_name(field, candidates);
  throw InputError(fmt::format("no row has a field '{}'{}", field,
                               near.empty() ? std::string() : fmt::format("; did you mean '{}'?", near)));
}

/// The distinct values of a field, quoted; at most eight.
std::string listed(const std::vector<const json*>& rows, const std::string& field) {
  std::vector<std::string> values;
  for (const json* row : rows) {
    const std::string value = text_of(*row, field);
    if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
  }
  constexpr std::size_t kMost = 8;
  const bool more = values.size() > kMost;
  if (more) values.resize(kMost);
  return fmt::format("'{}'{}", fmt::join(values, "', '"), more ? ", …" : "");
}

void check_one_machine(const std::vector<const json*>& rows) {
  for (const char* field : {"device", "driver"}) {
    for (const json* row : rows) {
      if (text_of(*row, field) == text_of(*rows.front(), field)) continue;
      throw InputError(fmt::format("rows of more than one {} are never pooled: {}; choose with --where {}=…", field,
                                   listed(rows, field), field));
    }
  }
}

/// The same whatever technique draws: differences between techniques count.
bool is_common(std::string_view setting) {
  return setting == "scene" || setting == "view" || setting == "size" || setting.find('.') != std::string_view::npos;
}

const ParameterTable* table_of(const std::string& technique) {
  for (const TechniqueInfo& info : techniques()) {
    if (info.name == technique) return &info.table();
  }
  return nullptr;
}

}  // namespace

std::optional<double> number(const json& row, std::string_view field) {
  const auto found = row.find(std::string(field));
  if (found == row.end() || !found->is_number()) return std::nullopt;
  const double value = found->get<double>();
  if (!std::isfinite(value)) return std::nullopt;
  return value;
}

std::string value_text(const json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  return value.dump();
}

Rows choose_rows(const std::vector<json>& rows, std::span<const Condition> conditions,
                 std::span<const std::string> fields) {
  if (rows.empty())
    throw InputError("there are no rows to draw: the store is empty, or no point has been measured yet");
  std::vector<const json*> left;
  for (const json& row : rows)
    left.push_back(&row);
  for (const Condition& condition : conditions) {
    check_field(rows, condition.field);
    std::vector<const json*> next;
    std::copy_if(left.begin(), left.end(), std::back_inserter(next),
                 [&](const json* row) { return meets(*row, condition); });
    if (next.empty()) {
      throw InputError(fmt::format("no row has {} = {}; there are {}", condition.field, condition.value,
                                   listed(left, condition.field)));
    }
    left = std::move(next);
  }

  Rows result;
  std::set<std::string> seen;
  for (const json* row : left) {
    if (row->contains("point") && !seen.insert(text_of(*row, "point")).second) continue;
    if (text_of(*row, "status") == "failed")
      ++result.failed;
    else if (!std::all_of(fields.begin(), fields.end(), [&](const auto& field) { return number(*row, field); }))
      ++result.incomplete;
    else
      result.kept.push_back(row);
  }
  if (result.kept.empty()) {
    if (result.incomplete > 0) {
      for (const std::string& field : fields)
        check_field(rows, field);
    }
    throw InputError(fmt::format("nothing to draw: of {} rows {} failed and {} lack a number for {}", seen.size(),
                                 result.failed, result.incomplete, fmt::join(fields, " or ")));
  }
  check_one_machine(result.kept);
  result.unconverged =
      static_cast<std::size_t>(std::count_if(result.kept.begin(), result.kept.end(),
                                             [](const json* row) { return text_of(*row, "timing") == "unconverged"; }));
  return result;
}

std::vector<std::pair<std::string, std::string>> settings(const json& row) {
  std::vector<std::pair<std::string, std::string>> result;
  const std::string technique = text_of(row, "technique");
  result.emplace_back("technique", technique);
  for (const char* field : {"scene", "view"}) {
    if (row.contains(field)) result.emplace_back(field, text_of(row, field));
  }
  if (row.contains("width") && row.contains("height")) {
    result.emplace_back("size", fmt::format("{}×{}", text_of(row, "width"), text_of(row, "height")));
  }
  const ParameterTable* table = table_of(technique);
  for (const auto& [name, value] : row.items()) {
    const bool parameter = name.find('.') != std::string::npos || (table != nullptr && table->find(name) != nullptr);
    if (parameter) result.emplace_back(name, value_text(value));
  }
  return result;
}

std::vector<Group> group_rows(const Rows& rows, std::span<const std::string> own) {
  const auto is_own = [&](const std::string& name) { return std::find(own.begin(), own.end(), name) != own.end(); };
  // Values of each setting: over all techniques for what is common to them, else for each technique by itself.
  std::map<std::string, std::set<std::string>> values;
  const auto key = [](const std::string& technique, const std::string& name) {
    return is_common(name) || name == "technique" ? name : technique + "\n" + name;
  };
  for (const json* row : rows.kept) {
    const std::string technique = text_of(*row, "technique");
    for (const auto& [name, value] : settings(*row))
      values[key(technique, name)].insert(value);
  }
  const bool one_technique = values["technique"].size() == 1;

  std::vector<Group> groups;
  for (const json* row : rows.kept) {
    const std::string technique = text_of(*row, "technique");
    std::vector<std::string> parts;
    for (const auto& [name, value] : settings(*row)) {
      if (is_own(name) || name == "technique" || values[key(technique, name)].size() < 2) continue;
      parts.push_back(fmt::format("{} = {}", name, value));
    }
    if (!is_own("technique") && (!one_technique || parts.empty())) {
      parts.insert(parts.begin(), technique_title(technique));
    }
    const std::string label = fmt::format("{}", fmt::join(parts, ", "));
    auto group = std::find_if(groups.begin(), groups.end(),
                              [&](const Group& g) { return g.label == label && g.technique == technique; });
    if (group == groups.end()) {
      const auto variant =
          std::count_if(groups.begin(), groups.end(), [&](const Group& g) { return g.technique == technique; });
      groups.push_back({label, technique, static_cast<std::size_t>(variant), {}});
      group = std::prev(groups.end());
    }
    group->rows.push_back(row);
  }
  return groups;
}

std::string provenance_note(const Rows& rows, bool timed) {
  std::vector<std::string> parts;
  const auto common = [&](const std::string& field) -> std::string {
    const std::string first = text_of(*rows.kept.front(), field);
    const bool all =
        std::all_of(rows.kept.begin(), rows.kept.end(), [&](const json* row) { return text_of(*row, field) == first; });
    return all ? first : std::string();
  };
  if (const std::string scene = common("scene"); !scene.empty()) parts.push_back(scene);
  if (const std::string width = common("width"), height = common("height"); !width.empty() && !height.empty()) {
    parts.push_back(fmt::format("{}×{}", width, height));
  }
  if (const std::string device = common("device"); !device.empty()) parts.push_back(device);
  if (const std::string clock = common("clock"); timed && !clock.empty()) {
    parts.push_back(clock == "gpu_query" ? "GPU timer queries" : "clock read after glFinish");
  }
  std::string note = fmt::format("{}.", fmt::join(parts, ", "));
  if (parts.empty()) note.clear();
  const auto add = [&](std::size_t count, std::string_view one, std::string_view many) {
    if (count > 0) note += fmt::format("{}{} {}.", note.empty() ? "" : " ", count, count == 1 ? one : many);
  };
  add(rows.failed, "failed point left out", "failed points left out");
  add(rows.incomplete, "point without these measurements left out", "points without these measurements left out");
  if (timed) add(rows.unconverged, "frame time did not converge", "frame times did not converge");
  return note;
}

}  // namespace pellucid::plots
