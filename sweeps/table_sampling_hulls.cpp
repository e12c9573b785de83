// Tables of Imagire et al. 2007 (references.bib: imagire2007).
#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sweeps/table_rows.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;

/// A column of Table 1: M hulls of N samples, 32 in all, and the frame rate that the paper gives.
struct Published {
  std::int64_t hulls, samples;
  double fps;
};
constexpr std::array<Published, 6> kTable1{
    {{1, 32, 50}, {2, 16, 59}, {4, 8, 64}, {8, 4, 62}, {16, 2, 55}, {32, 1, 47}}};
constexpr std::size_t kBest = 2;  // 4 hulls of 8 samples, which the paper recommends for this scene

struct Place {
  Published paper;
  const json* row;
  std::string outcome;

  std::string name() const { return fmt::format("{} × {}", paper.hulls, paper.samples); }
};

/// One row of ours: `value` where the point was measured, "failed" where it failed.
template <class F>
TableRow our_row(std::string label, const std::vector<Place>& places, int digits, F value,
                 unsigned in = TableRow::all) {
  TableRow row{std::move(label), {}, in};
  for (const Place& place : places) {
    TableCell cell;
    if (place.outcome == "failed") {
      cell.text = "failed";
    } else if (place.row != nullptr) {
      cell.value = value(*place.row);
      if (cell.value) cell.text = significant(*cell.value, digits);
    }
    row.cells.push_back(std::move(cell));
  }
  return row;
}

template <class F>
TableRow paper_row(std::string label, int decimals, F value) {
  TableRow row{std::move(label), {}, TableRow::all};
  for (const Published& paper : kTable1) {
    const double number = value(paper);
    row.cells.push_back({fmt::format("{:.{}f}", number, decimals), number});
  }
  return row;
}

/// A bound of the median's interval as frames a second: the frame's longest time is its lowest rate.
std::optional<double> fps_bound(const json& row, const char* frame_ms) {
  const auto ms = number(row, frame_ms);
  return ms && *ms > 0 ? std::optional(1000 / *ms) : std::nullopt;
}

std::vector<TableRow> interval_rows(const std::vector<Place>& places) {
  const auto low = [](const json& row) { return fps_bound(row, "frame_ms_ci95_high"); };
  const auto high = [](const json& row) { return fps_bound(row, "frame_ms_ci95_low"); };
  TableRow both = our_row("95 % interval", places, 4, low, TableRow::markdown);
  const TableRow upper = our_row("95 % interval, high", places, 4, high, TableRow::latex | TableRow::csv);
  TableRow lower = both;
  lower.label = "95 % interval, low";
  lower.in = upper.in;
  for (std::size_t i = 0; i < both.cells.size(); ++i) {
    if (both.cells[i].value && upper.cells[i].value) both.cells[i].text += "–" + upper.cells[i].text;
    both.cells[i].value.reset();
  }
  return {both, lower, upper};
}

std::optional<double> our_fps(const Place& place) {
  return place.row != nullptr && place.outcome != "failed" ? number(*place.row, "fps") : std::nullopt;
}

std::optional<double> relative_fps(const std::vector<Place>& places, std::size_t i) {
  const auto best = our_fps(places[kBest]);
  const auto fps = our_fps(places[i]);
  return best && fps && *best > 0 ? std::optional(*fps / *best) : std::nullopt;
}

TableRow our_relative_row(const std::string& label, const std::vector<Place>& places) {
  TableRow row{label, {}, TableRow::all};
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto value = relative_fps(places, i);
    row.cells.push_back({value ? fmt::format("{:.2f}", *value) : places[i].outcome == "failed" ? "failed" : "", value});
  }
  return row;
}

TableRecord record(const std::string& sweep, const std::vector<Place>& places, std::size_t i) {
  const Place& place = places[i];
  const bool measured = place.row != nullptr && place.outcome != "failed";
  const auto real = [](std::optional<double> v) { return v ? std::optional<Value>(*v) : std::nullopt; };
  const auto field = [&](const char* name) { return measured ? real(number(*place.row, name)) : std::nullopt; };
  const auto words = [&](const char* name) -> std::optional<Value> {
    if (place.row == nullptr || text(*place.row, name).empty()) return std::nullopt;
    return text(*place.row, name);
  };
  const auto whole = [&](const char* name) -> std::optional<Value> {
    const auto v = place.row == nullptr ? std::nullopt : number(*place.row, name);
    return v ? std::optional<Value>(static_cast<std::int64_t>(*v)) : std::nullopt;
  };
  return {{"hulls", place.paper.hulls},
          {"samples", place.paper.samples},
          {"quantity", std::string("fps")},
          {"paper", static_cast<std::int64_t>(place.paper.fps)},
          {"ours", real(our_fps(place))},
          {"ours_ci95_low", measured ? real(fps_bound(*place.row, "frame_ms_ci95_high")) : std::nullopt},
          {"ours_ci95_high", measured ? real(fps_bound(*place.row, "frame_ms_ci95_low")) : std::nullopt},
          {"paper_relative_to_4x8", place.paper.fps / kTable1[kBest].fps},
          {"ours_relative_to_4x8", real(relative_fps(places, i))},
          {"frame_ms_median", field("frame_ms_median")},
          {"flip_mean", field("flip_mean")},
          {"rmse", field("rmse")},
          {"outcome", place.outcome},
          {"failure", words("failure")},
          {"frames", whole("frames")},
          {"scene", words("scene")},
          {"view", words("view")},
          {"width", whole("width")},
          {"height", whole("height")},
          {"device", words("device")},
          {"driver", words("driver")},
          {"clock", words("clock")},
          {"commit", words("commit")},
          {"sweep", sweep.empty() ? std::nullopt : std::optional<Value>(sweep)}};
}

std::vector<std::string> names_of(const std::vector<Place>& places, std::string_view outcome) {
  std::vector<std::string> names;
  for (const Place& place : places) {
    if (place.outcome == outcome) names.push_back(place.name());
  }
  return names;
}

std::vector<std::string> outcome_notes(const std::vector<Place>& places) {
  std::vector<std::string> notes;
  if (const auto names = names_of(places, "unconverged"); !names.empty()) {
    notes.push_back(
        fmt::format("† unconverged, {} of {} points: the limit of frames or seconds came before the interval "
                    "was as narrow as asked for.",
                    names.size(), places.size()));
  }
  for (const Place& place : places) {
    if (place.outcome == "failed")
      notes.push_back(fmt::format("{} failed: {}", place.name(), text(*place.row, "failure")));
  }
  if (const auto names = names_of(places, "untimed"); !names.empty())
    notes.push_back(fmt::format("Measured without timing: {}.", fmt::join(names, ", ")));
  if (const auto names = names_of(places, "missing"); !names.empty())
    notes.push_back(fmt::format("Not measured yet: {}.", fmt::join(names, ", ")));
  return notes;
}

}  // namespace

TableInfo sampling_hulls_table1_info() {
  return {.name = "sampling_hulls.table1",
          .title = "Frame rate of the foggy forest for M hulls of N samples each, 32 samples in all",
          .source = "Imagire et al. 2007, Table 1",
          .spec = "sampling_hulls_table1"};
}

Table sampling_hulls_table1(const TableInfo& info, const ChosenRows& chosen) {
  std::vector<Place> places;
  for (const Published& paper : kTable1) {
    const json* row = find_row(chosen, "sampling_hulls", {{"hulls", paper.hulls}, {"samples", paper.samples}});
    places.push_back({paper, row, outcome(row)});
  }
  Table table{.info = info, .rows = {}, .heading_rows = 2, .records = {}, .notes = {}, .sweep = chosen.sweep};
  table.rows.push_back(paper_row("Number of hulls", 0, [](const Published& p) { return double(p.hulls); }));
  table.rows.push_back(paper_row("Number of samples", 0, [](const Published& p) { return double(p.samples); }));
  table.rows.push_back(paper_row("fps (paper)", 0, [](const Published& p) { return p.fps; }));
  TableRow fps = our_row("fps (ours)", places, 4, [](const json& row) { return number(row, "fps"); });
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i].outcome == "unconverged") fps.cells[i].text += "†";
  }
  table.rows.push_back(std::move(fps));
  for (TableRow& row : interval_rows(places))
    table.rows.push_back(std::move(row));
  const std::string relative = fmt::format("fps relative to {} ", places[kBest].name());
  table.rows.push_back(
      paper_row(relative + "(paper)", 2, [](const Published& p) { return p.fps / kTable1[kBest].fps; }));
  table.rows.push_back(our_relative_row(relative + "(ours)", places));
  table.rows.push_back(our_row("FLIP", places, 3, [](const json& row) { return number(row, "flip_mean"); }));
  table.rows.push_back(our_row("RMSE", places, 3, [](const json& row) { return number(row, "rmse"); }));
  TableRow outcomes{"outcome", {}, TableRow::csv};
  for (std::size_t i = 0; i < places.size(); ++i) {
    outcomes.cells.push_back({places[i].outcome, std::nullopt});
    table.records.push_back(record(chosen.sweep, places, i));
  }
  table.rows.push_back(std::move(outcomes));

  table.notes.push_back(
      fmt::format("Paper: {}: GeForce 7800 GTX, Pentium D 3.2 GHz, DirectX 9, 720 × 540, 16-bit floats.", info.source));
  for (std::string& note : provenance_notes(info, chosen))
    table.notes.push_back(std::move(note));
  if (!chosen.rows.empty()) {
    table.notes.push_back("FLIP (mean) and RMSE are of the scene-linear image against the ray-marched reference.");
    for (std::string& note : outcome_notes(places))
      table.notes.push_back(std::move(note));
  }
  return table;
}

}  // namespace pellucid::sweeps
