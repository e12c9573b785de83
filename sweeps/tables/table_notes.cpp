// The notes below a table: where its numbers come from and what to mind.
#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <toml++/toml.h>

#include "algorithms/scene/scene.hpp"
#include "gl/resources/resources.hpp"
#include "sweeps/tables/table_fill.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;

/// The scene that a scene file says it stands in for; empty for a scene that is not built in.
std::string stand_in(const std::string& scene) {
  for (const SceneInfo& info : list_scenes()) {
    if (info.name != scene) continue;
    const TomlFile file{fmt::format("algorithms/{}/scenes/{}.toml", info.module, scene)};
    return (*parse_toml(find_resource(file.shown).value_or(""), file))["stand_in"].value_or(std::string());
  }
  return "";
}

std::string clock_text(const std::string& clock) {
  if (clock == "gpu_query") return "timed by queries on the GPU";
  if (clock == "finish") return "timed on the host around glFinish";
  return clock.empty() ? "clock unknown" : "clock " + clock;
}

/// The sizes that the rows have, in the order they come.
std::string sizes_text(const RowPointers& rows) {
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

void add_commits(const RowPointers& rows, std::vector<std::string>& notes) {
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

void add_scenes(const RowPointers& rows, std::vector<std::string>& notes) {
  for (const std::string& scene : distinct(rows, "scene")) {
    RowPointers here;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(here),
                 [&](const json* row) { return text(*row, "scene") == scene; });
    const std::string instead = stand_in(scene);
    notes.push_back(fmt::format("Scene {}, view {}{}.", scene, fmt::join(distinct(here, "view"), ", "),
                                instead.empty() ? "" : ": " + instead));
  }
}

/// Device, driver, size, clock, scene and what stands in, frames, the reference's exactness, drift, commit.
void add_provenance(const TableSpec& spec, const RowPointers& rows, const std::string& sweep,
                    std::vector<std::string>& notes) {
  const auto names = machines(rows);
  const auto clocks = distinct(rows, "clock");
  const auto frames = extent(rows, "frames");
  notes.push_back(fmt::format("Ours: {}; {}{}.", names.empty() ? "device unknown" : *names.begin(), sizes_text(rows),
                              frames ? "; " + clock_text(fmt::format("{}", fmt::join(clocks, ", "))) : ""));
  add_scenes(rows, notes);
  if (frames) {
    const std::string count = frames->first == frames->second ? fmt::format("{}", frames->first)
                                                              : fmt::format("{} to {}", frames->first, frames->second);
    notes.push_back(
        fmt::format("Intervals are 95 % bootstrap intervals of the median, of {} frames per point.", count));
  }
  if (const std::string exactness = reference_exactness(rows); !exactness.empty())
    notes.push_back(fmt::format("The reference's own {}.", exactness));
  if (const auto drift = extent(rows, "baseline_drift")) {
    notes.push_back(
        fmt::format("The baseline's frame time changed by {:+.1f} % to {:+.1f} % in the course of the sweep.",
                    100 * drift->first, 100 * drift->second));
  }
  if (sweep != spec.info.spec) {
    notes.push_back(
        fmt::format("A preview: of the sweep {}, which takes fewer frames per point than {}.", sweep, spec.info.spec));
  }
  add_commits(rows, notes);
}

std::vector<std::string> names_of(const std::vector<TablePlace>& places, std::string_view outcome) {
  std::vector<std::string> names;
  for (const TablePlace& place : places) {
    if (place.outcome == outcome) names.push_back(place.name);
  }
  return names;
}

void add_outcomes(const std::vector<TablePlace>& places, bool times, std::vector<std::string>& notes) {
  if (const auto names = names_of(places, "unconverged"); times && !names.empty()) {
    notes.push_back(
        fmt::format("† unconverged, {} of {} points: the limit of frames or seconds came before the interval "
                    "was as narrow as asked for.",
                    names.size(), places.size()));
  }
  for (const TablePlace& place : places) {
    if (place.outcome == "failed")
      notes.push_back(fmt::format("{} failed: {}", place.name, text(*place.row, "failure")));
  }
  if (const auto names = names_of(places, "untimed"); times && !names.empty())
    notes.push_back(fmt::format("Measured without timing: {}.", fmt::join(names, ", ")));
  if (const auto names = names_of(places, "missing"); !names.empty())
    notes.push_back(fmt::format("Not measured yet: {}.", fmt::join(names, ", ")));
}

bool shows_times(const std::vector<FilledGroup>& groups) {
  return std::any_of(groups.begin(), groups.end(), [](const FilledGroup& group) {
    return std::any_of(group.lines.begin(), group.lines.end(),
                       [](const FilledLine& line) { return line.quantity != nullptr && line.quantity->time; });
  });
}

}  // namespace

std::vector<std::string> make_notes(const TableSpec& spec, const std::vector<FilledGroup>& groups,
                                    const std::string& sweep) {
  std::vector<std::string> notes;
  if (!spec.paper_note.empty()) notes.push_back(fmt::format("Paper: {}: {}.", spec.info.source, spec.paper_note));
  RowPointers rows;
  std::vector<TablePlace> places;
  for (const FilledGroup& group : groups) {
    rows.insert(rows.end(), group.used.begin(), group.used.end());
    places.insert(places.end(), group.places.begin(), group.places.end());
  }
  if (rows.empty()) return notes;
  add_provenance(spec, rows, sweep, notes);
  notes.insert(notes.end(), spec.notes.begin(), spec.notes.end());
  add_outcomes(places, shows_times(groups), notes);
  return notes;
}

}  // namespace pellucid::sweeps
