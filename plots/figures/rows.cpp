#include "plots/figures/rows.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/parameters.hpp"
#include "gl/error.hpp"
#include "plots/charts/style.hpp"
#include "sweeps/spec/constraint.hpp"

namespace pellucid::plots {
namespace {

using nlohmann::json;

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

/// The distinct values of a field, quoted; at most eight, those nearest to the number that was wanted first.
std::string listed(const std::vector<const json*>& rows, const std::string& field, const std::string& wanted = {}) {
  std::vector<std::string> values;
  for (const json* row : rows) {
    const std::string value = field_text(*row, field);
    if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
  }
  const auto distance = [&](const std::string& value) {
    double a = 0, b = 0;
    const auto read = [](const std::string& text, double& out) {
      return std::from_chars(text.data(), text.data() + text.size(), out).ec == std::errc{};
    };
    return read(value, a) && read(wanted, b) ? std::abs(a - b) : 0;
  };
  std::stable_sort(values.begin(), values.end(),
                   [&](const std::string& a, const std::string& b) { return distance(a) < distance(b); });
  constexpr std::size_t kMost = 8;
  const bool more = values.size() > kMost;
  if (more) values.resize(kMost);
  return fmt::format("'{}'{}", fmt::join(values, "', '"), more ? ", …" : "");
}

void check_one_machine(const std::vector<const json*>& rows) {
  for (const char* field : {"device", "driver"}) {
    for (const json* row : rows) {
      if (field_text(*row, field) == field_text(*rows.front(), field)) continue;
      throw InputError(fmt::format("rows of more than one {} are never pooled: {}; choose with --where {}=…", field,
                                   listed(rows, field), field));
    }
  }
}

/// The same whatever technique draws: differences between techniques count.
bool is_common(std::string_view setting) {
  return setting == "scene" || setting == "view" || setting == "size" || setting.find('.') != std::string_view::npos;
}

bool meets(const json& row, const Where& where) {
  return std::any_of(where.values.begin(), where.values.end(), [&](const std::string& value) {
    return sweeps::meets(row, {where.field, value});
  });
}

}  // namespace

const Quantity* Fields::find(std::string_view field) const {
  return paper_ == nullptr ? sweeps::find_quantity(field) : paper_->find_quantity(field);
}

std::optional<double> Fields::value(const json& row, const std::string& field) const {
  const Quantity* quantity = find(field);
  return quantity == nullptr ? number(row, field) : sweeps::value_of(*quantity, row);
}

std::vector<std::string> Fields::sources_of(const std::string& field) const {
  if (field.empty()) return {};
  const Quantity* quantity = find(field);
  if (quantity == nullptr || quantity->expressions.empty()) return {field};
  std::vector<std::string> sources;
  for (const auto& [technique, expression] : quantity->expressions) {
    for (const std::string& source : expression->used()) {
      if (std::find(sources.begin(), sources.end(), source) == sources.end()) sources.push_back(source);
    }
  }
  return sources;
}

bool Fields::is_time(const std::string& field) const {
  const Quantity* quantity = find(field);
  if (quantity == nullptr) return false;
  const std::vector<std::string> sources = sources_of(field);
  return quantity->time || std::any_of(sources.begin(), sources.end(),
                                       [&](const std::string& source) { return source != field && is_time(source); });
}

Rows choose_rows(const std::vector<json>& rows, std::span<const Where> where, std::span<const std::string> needed,
                 const Fields& fields) {
  if (rows.empty())
    throw InputError("there are no rows to draw: the store is empty, or no point has been measured yet");
  std::vector<const json*> left;
  for (const json& row : rows)
    left.push_back(&row);
  for (const Where& condition : where) {
    check_field(rows, condition.field);
    std::vector<const json*> next;
    std::copy_if(left.begin(), left.end(), std::back_inserter(next),
                 [&](const json* row) { return meets(*row, condition); });
    if (next.empty()) {
      throw InputError(fmt::format("no row has {} = {}; there are {}", condition.field,
                                   fmt::join(condition.values, " or "),
                                   listed(left, condition.field, condition.values.front())));
    }
    left = std::move(next);
  }

  // A field that is a parameter of some technique does not exist for the others.
  std::set<std::string> parameters;
  for (const json* row : left) {
    for (const auto& [name, value] : settings(*row))
      parameters.insert(name);
  }
  const auto of_another_technique = [&](const json& row, const std::string& field) {
    const std::vector<std::string> sources = fields.sources_of(field);
    return std::any_of(sources.begin(), sources.end(),
                       [&](const std::string& source) { return parameters.contains(source) && !row.contains(source); });
  };
  const auto timed = [&](const std::string& field) { return fields.is_time(field); };
  Rows result;
  std::set<std::string> seen;
  for (const json* row : left) {
    std::vector<std::string> missing;
    std::copy_if(needed.begin(), needed.end(), std::back_inserter(missing),
                 [&](const std::string& field) { return !fields.value(*row, field); });
    if (std::any_of(missing.begin(), missing.end(),
                    [&](const auto& field) { return of_another_technique(*row, field); }))
      continue;
    if (row->contains("point") && !seen.insert(field_text(*row, "point")).second) continue;
    if (field_text(*row, "status") == "failed")
      ++result.failed;
    else if (missing.empty())
      result.kept.push_back(row);
    else if (field_text(*row, "timing") == "off" && std::all_of(missing.begin(), missing.end(), timed))
      ++result.untimed;
    else
      ++result.incomplete;
  }
  if (result.kept.empty()) {
    for (const std::string& field : needed) {
      for (const std::string& source : fields.sources_of(field))
        check_field(rows, source);
    }
    throw InputError(fmt::format("nothing to draw: no row has a number for {}; {} failed, {} were not timed",
                                 fmt::join(needed, " and "), result.failed, result.untimed));
  }
  check_one_machine(result.kept);
  result.unconverged =
      static_cast<std::size_t>(std::count_if(result.kept.begin(), result.kept.end(), [](const json* row) {
        return field_text(*row, "timing") == "unconverged";
      }));
  return result;
}

namespace {

/// How often each setting takes each value: over all techniques for what is common to them, else for each technique by
/// itself. Settings that never change are left out.
class Variation {
 public:
  Variation(const Rows& rows, std::span<const std::string> own) {
    for (const json* row : rows.kept) {
      const std::string technique = field_text(*row, "technique");
      for (const auto& [name, value] : settings(*row)) {
        if (name == "technique" || std::find(own.begin(), own.end(), name) != own.end()) continue;
        Setting& setting = settings_[key(technique, name)];
        setting.name = name;
        auto found = std::find_if(setting.values.begin(), setting.values.end(),
                                  [&value = value](const auto& known) { return known.first == value; });
        if (found == setting.values.end()) found = setting.values.insert(found, {value, 0});
        ++found->second;
        const auto raw = row->find(name);
        if (raw == row->end() || !raw->is_string()) setting.in_words = false;
      }
    }
    std::erase_if(settings_, [](const auto& entry) { return entry.second.values.size() < 2; });
  }

  bool varies(const std::string& technique, const std::string& name) const {
    return settings_.contains(key(technique, name));
  }
  /// Whether it goes without saying: the value, a word, is the one that most rows have.
  bool is_usual(const std::string& technique, const std::string& name, const std::string& value) const {
    const Setting& setting = settings_.at(key(technique, name));
    return setting.in_words && setting.usual() == value;
  }
  /// "coordinates automatic", each once.
  std::vector<std::string> usual() const {
    std::vector<std::string> result;
    for (const auto& [place, setting] : settings_) {
      const std::string text = setting.name + " " + setting.usual();
      if (setting.in_words && std::find(result.begin(), result.end(), text) == result.end()) result.push_back(text);
    }
    return result;
  }

 private:
  struct Setting {
    std::string name;
    std::vector<std::pair<std::string, std::size_t>> values;  ///< in the order of their first appearance
    bool in_words = true;
    const std::string& usual() const {
      return std::max_element(values.begin(), values.end(),
                              [](const auto& a, const auto& b) { return a.second < b.second; })
          ->first;
    }
  };
  static std::string key(const std::string& technique, const std::string& name) {
    return is_common(name) ? name : technique + "\n" + name;
  }
  std::map<std::string, Setting> settings_;
};

}  // namespace

std::vector<Group> group_rows(const Rows& rows, std::span<const std::string> own, Labels labels) {
  const Variation variation(rows, own);
  const bool by_technique = std::find(own.begin(), own.end(), "technique") == own.end();
  const bool one_technique = std::all_of(rows.kept.begin(), rows.kept.end(), [&](const json* row) {
    return field_text(*row, "technique") == field_text(*rows.kept.front(), "technique");
  });
  std::vector<Group> groups;
  std::vector<std::string> keys;  // of the groups: every setting that divides, named in the label or not
  for (const json* row : rows.kept) {
    const std::string technique = field_text(*row, "technique");
    std::string key = by_technique ? technique : std::string();
    std::vector<std::string> parts;
    for (const auto& [name, value] : settings(*row)) {
      if (!variation.varies(technique, name)) continue;
      key += fmt::format("\n{}={}", name, value);
      if (labels == Labels::unusual && variation.is_usual(technique, name, value)) continue;
      parts.push_back(fmt::format("{} = {}", name, value));
    }
    const auto found = std::find(keys.begin(), keys.end(), key);
    if (found == keys.end()) {
      if (by_technique && (!one_technique || parts.empty())) parts.insert(parts.begin(), technique_title(technique));
      const auto variant =
          std::count_if(groups.begin(), groups.end(), [&](const Group& g) { return g.technique == technique; });
      groups.push_back(
          {fmt::format("{}", fmt::join(parts, ", ")), technique, static_cast<std::size_t>(variant), {row}});
      keys.push_back(key);
    } else {
      groups[static_cast<std::size_t>(found - keys.begin())].rows.push_back(row);
    }
  }
  return groups;
}

std::string usual_note(const Rows& rows, std::span<const std::string> own) {
  const std::vector<std::string> usual = Variation(rows, own).usual();
  return usual.empty() ? std::string() : fmt::format("Unless named: {}.", fmt::join(usual, ", "));
}

void check_distinct(const std::vector<Group>& groups, std::span<const std::string> own) {
  for (const Group& group : groups) {
    std::map<std::string, const json*> seen;
    for (const json* row : group.rows) {
      std::vector<std::string> parts;
      for (const std::string& name : own) {
        if (row->contains(name)) parts.push_back(fmt::format("{} = {}", name, field_text(*row, name)));
      }
      const std::string place = fmt::format("{}", fmt::join(parts, ", "));
      const auto [first, fresh] = seen.try_emplace(place, row);
      if (fresh) continue;
      throw InputError(
          fmt::format("'{}' was measured more than once at {} (points {} and {}), and measurements are "
                      "never pooled; choose with --where sweep=…, block=… or point=…",
                      group.label, place, field_text(*first->second, "point"), field_text(*row, "point")));
    }
  }
}

std::string provenance_note(const Rows& rows, bool timed) {
  std::vector<std::string> parts;
  const auto common = [&](const std::string& field) -> std::string {
    const std::string first = field_text(*rows.kept.front(), field);
    const bool all = std::all_of(rows.kept.begin(), rows.kept.end(),
                                 [&](const json* row) { return field_text(*row, field) == first; });
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
  add(rows.untimed, "point measured without timing left out", "points measured without timing left out");
  add(rows.incomplete, "point without these measurements left out", "points without these measurements left out");
  if (timed) add(rows.unconverged, "frame time did not converge", "frame times did not converge");
  return note;
}

}  // namespace pellucid::plots
