#include "sweeps/tables/table_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <toml++/toml.h>

#include "algorithms/scene/scene.hpp"
#include "gl/error.hpp"
#include "gl/resources.hpp"
#include "sweeps/spec/point_json.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;
using Rows = std::vector<const json*>;

Rows of_device(const TableInfo& info, const Rows& rows, std::string_view device) {
  Rows kept;
  bool any = false;
  for (const json* row : rows) {
    const std::string name = machine(*row);
    const bool wanted = name.find(device) != std::string::npos;
    any = any || wanted;
    if (wanted || name.empty()) kept.push_back(row);
  }
  if (!any) {
    throw InputError(fmt::format("no row of {} is of a device or driver with '{}' in its name; there are: '{}'",
                                 info.spec, device, fmt::join(machines(rows), "', '")));
  }
  return kept;
}

/// What a scene file says that it stands in for; empty for a scene that is not built in.
std::string stand_in(const std::string& scene) {
  for (const SceneInfo& info : list_scenes()) {
    if (info.name != scene) continue;
    const std::string path = fmt::format("algorithms/{}/scenes/{}.toml", info.module, scene);
    const toml::table file = toml::parse(find_resource(path).value_or(""), path);
    return file["stand_in"].value_or(std::string());
  }
  return "";
}

std::string clock_text(const std::string& clock) {
  if (clock == "gpu_query") return "timed by queries on the GPU";
  if (clock == "finish") return "timed on the host around glFinish";
  return clock.empty() ? "clock unknown" : "clock " + clock;
}

/// Sizes, scenes and views that the rows have, in the order they come.
std::string sizes_text(const Rows& rows) {
  std::vector<std::string> sizes;
  for (const json* row : rows) {
    const auto width = number(*row, "width");
    const auto height = number(*row, "height");
    if (!width || !height) continue;
    const std::string size = fmt::format("{} × {}", *width, *height);
    if (std::find(sizes.begin(), sizes.end(), size) == sizes.end()) sizes.push_back(size);
  }
  return fmt::format("{}", fmt::join(sizes, " and "));
}

void note_commit(const Rows& rows, std::vector<std::string>& notes) {
  std::vector<std::string> commits;
  for (const std::string& commit : distinct(rows, "commit")) {
    const bool dirty = std::any_of(rows.begin(), rows.end(), [&](const json* row) {
      return text(*row, "commit") == commit && row->value("dirty", json()) == json(true);
    });
    commits.push_back(commit.substr(0, 12) + (dirty ? " with uncommitted changes" : ""));
  }
  if (commits.empty()) return;
  notes.push_back(
      fmt::format("{} {}.", commits.size() > 1 ? "Rows of several commits:" : "Commit", fmt::join(commits, ", ")));
}

}  // namespace

ChosenRows choose_rows(const TableInfo& info, const std::vector<json>& rows, std::string_view device) {
  ChosenRows chosen = rows_of_sweep(rows, info.spec);
  if (chosen.rows.empty()) return chosen;
  if (!device.empty()) chosen.rows = of_device(info, chosen.rows, device);
  if (const auto names = machines(chosen.rows); names.size() > 1) {
    throw InputError(
        fmt::format("{} has rows of {} devices or drivers, which are never pooled: '{}'; choose one with "
                    "--device-name",
                    chosen.sweep, names.size(), fmt::join(names, "', '")));
  }
  return chosen;
}

const json* find_row(const ChosenRows& chosen, std::string_view technique,
                     const std::vector<std::pair<std::string, std::int64_t>>& parameters) {
  const json* found = nullptr;
  for (const json* row : chosen.rows) {
    if (text(*row, "technique") != technique) continue;
    const bool here = std::all_of(parameters.begin(), parameters.end(), [&](const auto& p) {
      return row->contains(p.first) && row->at(p.first) == json(p.second);
    });
    if (!here) continue;
    // A point that stands in two blocks of its spec is one measurement.
    const std::string point = text(*row, "point");
    if (found != nullptr && (point.empty() || point != text(*found, "point"))) {
      std::vector<std::string> place;
      for (const auto& [name, value] : parameters)
        place.push_back(fmt::format("{} = {}", name, value));
      throw InputError(fmt::format("{} has two rows for {}: {}; a table shows one", chosen.sweep,
                                   fmt::join(place, ", "), difference(*found, *row)));
    }
    found = row;
  }
  return found;
}

const json* find_row_of(const ChosenRows& chosen, std::string_view block,
                        const std::vector<std::pair<std::string, Value>>& values) {
  const json* found = nullptr;
  for (const json* row : chosen.rows) {
    if (text(*row, "block") != block) continue;
    const bool here = std::all_of(values.begin(), values.end(), [&](const auto& v) {
      return row->contains(v.first) && row->at(v.first) == value_to_json(v.second);
    });
    if (!here) continue;
    if (found != nullptr && text(*row, "point") != text(*found, "point")) {
      std::vector<std::string> place;
      for (const auto& [name, value] : values)
        place.push_back(fmt::format("{} = {}", name, to_text(value)));
      throw InputError(fmt::format("{} has two rows for {} of block {}: {}; a table shows one", chosen.sweep,
                                   fmt::join(place, ", "), block, difference(*found, *row)));
    }
    found = row;
  }
  return found;
}

ChosenRows rows_of_blocks(const ChosenRows& chosen, const std::vector<std::string>& prefixes) {
  ChosenRows out{chosen.sweep, {}};
  for (const json* row : chosen.rows) {
    const std::string block = text(*row, "block");
    if (std::any_of(prefixes.begin(), prefixes.end(), [&](const std::string& p) { return block.starts_with(p); }))
      out.rows.push_back(row);
  }
  return out;
}

std::vector<std::string> provenance_notes(const TableInfo& info, const ChosenRows& chosen) {
  const Rows& rows = chosen.rows;
  std::vector<std::string> notes;
  if (rows.empty()) return notes;
  const auto names = machines(rows);
  const auto clocks = distinct(rows, "clock");
  const auto frames = extent(rows, "frames");
  notes.push_back(fmt::format(
      "Ours: {}; {}{}.", names.empty() ? "device unknown" : *names.begin(), sizes_text(rows),
      frames ? "; " + clock_text(clocks.size() == 1 ? *clocks.begin() : fmt::format("{}", fmt::join(clocks, ", ")))
             : ""));
  for (const std::string& scene : distinct(rows, "scene")) {
    Rows here;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(here),
                 [&](const json* row) { return text(*row, "scene") == scene; });
    const std::string instead = stand_in(scene);
    notes.push_back(fmt::format("Scene {}, view {}{}.", scene, fmt::join(distinct(here, "view"), ", "),
                                instead.empty() ? "" : ": " + instead));
  }
  if (frames) {
    const std::string count = frames->first == frames->second ? fmt::format("{}", frames->first)
                                                              : fmt::format("{} to {}", frames->first, frames->second);
    notes.push_back(fmt::format("Intervals are 95 % bootstrap intervals of the median, of {} frames a point.", count));
  }
  const auto worst = extent(rows, "reference_step_error_max");
  const auto mean = extent(rows, "reference_step_error_mean");
  if (worst && mean) {
    notes.push_back(fmt::format("The reference's own step error is at most {}, {} in the mean.",
                                significant(worst->second, 2), significant(mean->second, 2)));
  }
  if (const auto drift = extent(rows, "baseline_drift")) {
    notes.push_back(
        fmt::format("The baseline's frame time changed by {:+.1f} % to {:+.1f} % in the course of the sweep.",
                    100 * drift->first, 100 * drift->second));
  }
  if (chosen.sweep != info.spec) {
    notes.push_back(
        fmt::format("A preview: of the sweep {}, which takes fewer frames a point than {}.", chosen.sweep, info.spec));
  }
  note_commit(rows, notes);
  return notes;
}

}  // namespace pellucid::sweeps
