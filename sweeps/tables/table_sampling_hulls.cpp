// Tables of Imagire et al. 2007 (references.bib: imagire2007).
#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sweeps/tables/table_places.hpp"

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

std::vector<std::optional<double>> published(double (*value)(const Published&)) {
  std::vector<std::optional<double>> values;
  for (const Published& paper : kTable1)
    values.emplace_back(value(paper));
  return values;
}

std::optional<double> relative_fps(const std::vector<Place>& places, std::size_t i) {
  const auto best = fps(places[kBest]);
  const auto rate = fps(places[i]);
  return best && rate && *best > 0 ? std::optional(*rate / *best) : std::nullopt;
}

TableRecord record(const std::string& sweep, const std::vector<Place>& places, std::size_t i) {
  const Place& place = places[i];
  const Published& paper = kTable1.at(i);
  const auto bound = [&](const char* frame_ms) {
    return place.measured() ? real_value(fps_bound(*place.row, frame_ms)) : std::nullopt;
  };
  TableRecord out{{"hulls", paper.hulls},
                  {"samples", paper.samples},
                  {"quantity", std::string("fps")},
                  {"paper", static_cast<std::int64_t>(paper.fps)},
                  {"ours", real_value(fps(place))},
                  {"ours_ci95_low", bound("frame_ms_ci95_high")},
                  {"ours_ci95_high", bound("frame_ms_ci95_low")},
                  {"paper_relative_to_4x8", paper.fps / kTable1[kBest].fps},
                  {"ours_relative_to_4x8", real_value(relative_fps(places, i))},
                  {"frame_ms_median", real_field(place, "frame_ms_median")},
                  {"flip_mean", real_field(place, "flip_mean")},
                  {"rmse", real_field(place, "rmse")}};
  add_origin(out, place, sweep);
  return out;
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
    places.push_back(
        make_place(fmt::format("{} × {}", paper.hulls, paper.samples),
                   find_row(chosen, "sampling_hulls", {{"hulls", paper.hulls}, {"samples", paper.samples}})));
  }
  Table table{.info = info, .rows = {}, .heading_rows = 2, .records = {}, .notes = {}, .sweep = chosen.sweep};
  table.rows.push_back(paper_row("Number of hulls", 0, published([](const Published& p) { return double(p.hulls); })));
  table.rows.push_back(
      paper_row("Number of samples", 0, published([](const Published& p) { return double(p.samples); })));
  table.rows.push_back(paper_row("fps (paper)", 0, published([](const Published& p) { return p.fps; })));
  table.rows.push_back(fps_row("fps (ours)", places));
  for (TableRow& row : interval_rows(places))
    table.rows.push_back(std::move(row));
  const std::string relative = fmt::format("fps relative to {} ", places[kBest].name);
  table.rows.push_back(
      paper_row(relative + "(paper)", 2, published([](const Published& p) { return p.fps / kTable1[kBest].fps; })));
  std::vector<std::optional<double>> ours;
  for (std::size_t i = 0; i < places.size(); ++i)
    ours.push_back(relative_fps(places, i));
  table.rows.push_back(value_row(relative + "(ours)", places, 2, ours));
  table.rows.push_back(our_row("FLIP", places, 3, [](const json& row) { return number(row, "flip_mean"); }));
  table.rows.push_back(our_row("RMSE", places, 3, [](const json& row) { return number(row, "rmse"); }));
  for (std::size_t i = 0; i < places.size(); ++i)
    table.records.push_back(record(chosen.sweep, places, i));
  table.rows.push_back(outcome_row(places));

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
