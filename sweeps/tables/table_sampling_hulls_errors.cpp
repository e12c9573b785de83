// Tables of errors that Imagire et al. 2007 (references.bib: imagire2007) judge by eye: measured, without a published
// number beside them.
#include <cmath>
#include <cstdint>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sweeps/tables/table_places.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;

struct Count {
  std::int64_t hulls, samples;
  std::string name() const { return fmt::format("{} × {}", hulls, samples); }
};
const std::vector<Count> kCounts{{2, 4}, {4, 4}, {4, 8}, {8, 8}, {8, 16}};

/// A scene of the paper and the figure that shows it.
struct Subject {
  const char* figure;  ///< "Fig. 8"
  const char* scene;   ///< whose name, or name_procedural, rows have
  const char* block;   ///< prefix of its blocks, where a spec has blocks for each scene
};

using Numbers = std::vector<std::optional<double>>;

Table start(const TableInfo& info, const ChosenRows& chosen) {
  Table table{.info = info, .rows = {}, .heading_rows = 1, .records = {}, .notes = {}, .sweep = chosen.sweep};
  TableRow heading{"M × N", {}, TableRow::all};
  for (const Count& count : kCounts)
    heading.cells.push_back({count.name(), std::nullopt});
  table.rows.push_back(std::move(heading));
  return table;
}

TableRow number_row(std::string label, const Numbers& values, int digits) {
  TableRow row{std::move(label), {}, TableRow::all};
  for (const auto& value : values)
    row.cells.push_back({value ? significant(*value, digits) : "", value});
  return row;
}

TableRow ratio_row(std::string label, const Numbers& over, const Numbers& under) {
  TableRow row{std::move(label), {}, TableRow::all};
  for (std::size_t i = 0; i < over.size(); ++i) {
    std::optional<double> ratio;
    if (over[i] && under[i] && *under[i] > 0) ratio = *over[i] / *under[i];
    row.cells.push_back({ratio ? fmt::format("{:.2f}", *ratio) : "", ratio});
  }
  return row;
}

std::optional<double> cell_value(const TableRow& row, std::size_t i) {
  return row.cells[i].value;
}

std::optional<double> measured(const json* row, const char* field) {
  return row != nullptr && outcome(row) != "failed" ? number(*row, field) : std::nullopt;
}

/// The scene's name in these rows: the paper's stand-in, or its variant without assets.
std::string scene_in(const ChosenRows& chosen, const Subject& subject) {
  for (const json* row : chosen.rows) {
    const std::string scene = text(*row, "scene");
    if (scene == subject.scene || scene == std::string(subject.scene) + "_procedural") return scene;
  }
  return subject.scene;
}

void add_provenance(Table& table, const ChosenRows& chosen) {
  for (std::string& note : provenance_notes(table.info, chosen))
    table.notes.push_back(std::move(note));
}

/// "3 of 10 ratios are above 0.5".
struct Tally {
  int above = 0, all = 0;
  void add(const TableRow& row, double bound) {
    for (const TableCell& cell : row.cells) {
      if (!cell.value) continue;
      ++all;
      if (*cell.value > bound) ++above;
    }
  }
};

// ---- hulls against slices of equally many samples ----

const std::vector<Subject> kEqualSubjects{{"Fig. 8", "fog_forest", ""}, {"Fig. 11", "statue_spotlight", ""}};

/// A way to set the hulls, and the slices that it is held against.
struct Way {
  const char* label;
  const char* hulls;   ///< block
  const char* slices;  ///< block
};
constexpr Way kWays[] = {{"points at the back, as in the paper", "hulls", "slices"},
                         {"points at the back, local coordinates in floats", "hulls_float_map", "slices"},
                         {"points in the middle", "hulls_middle", "slices"},
                         {"points in the middle, 32-bit floats", "hulls_middle_single", "slices_single"}};

void add_equal(const Subject& subject, const Way& way, const ChosenRows& chosen, Table& table, Tally& tally) {
  const std::string scene = scene_in(chosen, subject);
  Numbers of_slices, of_hulls;
  std::vector<const json*> rows;
  for (const Count& count : kCounts) {
    of_slices.push_back(measured(
        find_row_of(chosen, way.slices, {{"scene", scene}, {"slices", count.hulls * count.samples}}), "flip_mean"));
    rows.push_back(
        find_row_of(chosen, way.hulls, {{"scene", scene}, {"hulls", count.hulls}, {"samples", count.samples}}));
    of_hulls.push_back(measured(rows.back(), "flip_mean"));
  }
  const std::string at = fmt::format("{}, {}", subject.figure, way.label);
  table.rows.push_back(number_row(at + ": FLIP, M·N slices", of_slices, 3));
  table.rows.push_back(number_row(at + ": FLIP, hulls", of_hulls, 3));
  table.rows.push_back(ratio_row(at + ": ratio", of_hulls, of_slices));
  tally.add(table.rows.back(), 0.5);
  for (std::size_t i = 0; i < kCounts.size(); ++i) {
    TableRecord record{{"figure", std::string(subject.figure)},
                       {"way", std::string(way.label)},
                       {"hulls", kCounts[i].hulls},
                       {"samples", kCounts[i].samples},
                       {"quantity", std::string("flip_mean of hulls over that of slices")},
                       {"paper", std::nullopt},
                       {"ours", real_value(cell_value(table.rows.back(), i))},
                       {"flip_mean_hulls", real_value(of_hulls[i])},
                       {"flip_mean_slices", real_value(of_slices[i])}};
    add_origin(record, make_place(kCounts[i].name(), rows[i]), chosen.sweep);
    table.records.push_back(std::move(record));
  }
}

// ---- averaged occlusion in the shadows ----

const std::vector<Subject> kShadowSubjects{{"Fig. 10", "teapot_room", "fig10"},
                                           {"Fig. 11", "statue_spotlight", "fig11"}};

void add_shadows(const Subject& subject, bool middle, const ChosenRows& chosen, Table& table, Tally& tally) {
  const std::string block = fmt::format("{}_counts_{}", subject.block, middle ? "middle" : "back");
  const std::string at = fmt::format("{}, points {}", subject.figure, middle ? "in the middle" : "at the back");
  for (const auto& [name, field] : {std::pair{"FLIP", "flip_mean_shadow"}, std::pair{"RMSE", "rmse_shadow"}}) {
    Numbers plain, filtered;
    std::vector<const json*> rows;
    for (const Count& count : kCounts) {
      const std::vector<std::pair<std::string, Value>> here{{"hulls", count.hulls}, {"samples", count.samples}};
      plain.push_back(measured(find_row_of(chosen, block + "_unfiltered", here), field));
      rows.push_back(find_row_of(chosen, block, here));
      filtered.push_back(measured(rows.back(), field));
    }
    table.rows.push_back(number_row(fmt::format("{}: {}, one rate", at, name), plain, 3));
    table.rows.push_back(number_row(fmt::format("{}: {}, averaged", at, name), filtered, 3));
    table.rows.push_back(ratio_row(fmt::format("{}: {}, ratio", at, name), filtered, plain));
    tally.add(table.rows.back(), 1.0);
    for (std::size_t i = 0; i < kCounts.size(); ++i) {
      TableRecord record{{"figure", std::string(subject.figure)},
                         {"sample_offset", middle ? 0.5 : 0.0},
                         {"hulls", kCounts[i].hulls},
                         {"samples", kCounts[i].samples},
                         {"quantity", fmt::format("{} averaged over one rate", field)},
                         {"paper", std::nullopt},
                         {"ours", real_value(cell_value(table.rows.back(), i))},
                         {"averaged", real_value(filtered[i])},
                         {"one_rate", real_value(plain[i])}};
      add_origin(record, make_place(kCounts[i].name(), rows[i]), chosen.sweep);
      table.records.push_back(std::move(record));
    }
  }
}

// ---- the two references ----

struct Picture {
  const char* label;
  const char* figure;  ///< prefix of the blocks
  const char* view;
  std::optional<double> time_s;
};
const std::vector<Picture> kPictures{
    {"Fig. 8", "fig8", "path", {}},         {"Fig. 9 (a)", "fig9", "front", {}},
    {"Fig. 9 (b)", "fig9", "above", {}},    {"Fig. 10 (a)", "fig10", "front", 0.0},
    {"Fig. 10 (b)", "fig10", "front", 5.0}, {"Fig. 11 (a)", "fig11", "front", {}},
    {"Fig. 11 (c)", "fig11", "shadow", {}},
};

}  // namespace

TableInfo sampling_hulls_equal_info() {
  return {.name = "sampling_hulls.equal",
          .title = "FLIP of M × N hulls over that of M·N slices, in the scenes of Figs. 8 and 11",
          .source = "ours; after Imagire et al. 2007, Figs. 8 and 11",
          .spec = "sampling_hulls_equal"};
}

Table sampling_hulls_equal(const TableInfo& info, const ChosenRows& chosen) {
  Table table = start(info, chosen);
  Tally tally;
  for (const Subject& subject : kEqualSubjects) {
    for (const Way& way : kWays)
      add_equal(subject, way, chosen, table, tally);
  }
  table.notes.emplace_back(
      "Slices stand in the middle of their slabs. The error is of the scene-linear image against the exact reference "
      "of "
      "the same opaque surfaces, shadow maps included.");
  if (tally.all > 0) {
    table.notes.push_back(fmt::format("{} of {} ratios are above 0.5.",
                                      tally.above == 0 ? "None" : std::to_string(tally.above), tally.all));
    if (tally.above > 0) {
      table.notes.emplace_back(
          "Why some are: points at the back of their steps are of first order, slices in the middle of second; local "
          "coordinates of 8 bits have steps; and where the light itself changes fast, as in Fig. 11 near the lamp and "
          "at "
          "the edges of cone and shadow, both take equally long steps, and to end on the surface helps little.");
    }
  }
  add_provenance(table, chosen);
  return table;
}

TableInfo sampling_hulls_shadows_info() {
  return {.name = "sampling_hulls.shadows",
          .title = "Error in the shadows of Figs. 10 and 11 with averaged occlusion rates (Eq. 4) and without",
          .source = "ours; after Imagire et al. 2007, Sec. 3.3",
          .spec = "sampling_hulls_shadows"};
}

Table sampling_hulls_shadows(const TableInfo& info, const ChosenRows& all) {
  const ChosenRows chosen = rows_of_blocks(all, {"fig10_counts", "fig11_counts"});
  Table table = start(info, chosen);
  table.sweep = chosen.rows.empty() ? "" : chosen.sweep;
  Tally tally;
  for (const Subject& subject : kShadowSubjects) {
    for (const bool middle : {false, true})
      add_shadows(subject, middle, chosen, table, tally);
  }
  table.notes.emplace_back(
      "In the shadows: where the shadows in the medium take more than 5 % of the pixel's luminance. Shadow maps of 256 "
      "× "
      "256 texels.");
  if (tally.all > 0) {
    table.notes.push_back(
        fmt::format("Averaging lowers the error in {} of {} cases.", tally.all - tally.above, tally.all));
  }
  add_provenance(table, chosen);
  return table;
}

TableInfo sampling_hulls_references_info() {
  return {.name = "sampling_hulls.references",
          .title = "The paper's reference, 1,024 slices, against the exact one",
          .source = "ours; after Imagire et al. 2007, Sec. 5",
          .spec = "sampling_hulls_figures"};
}

Table sampling_hulls_references(const TableInfo& info, const ChosenRows& all) {
  const ChosenRows chosen =
      rows_of_blocks(all, {"fig8_by_slices", "fig9_by_slices", "fig10_by_slices", "fig11_by_slices", "fig8_hulls",
                           "fig9_hulls", "fig10_hulls", "fig11_hulls"});
  Table table{.info = info, .rows = {}, .heading_rows = 1, .records = {}, .notes = {}, .sweep = chosen.sweep};
  if (chosen.rows.empty()) table.sweep.clear();
  TableRow heading{"Picture", {}, TableRow::all};
  for (const Picture& picture : kPictures)
    heading.cells.push_back({picture.label, std::nullopt});
  table.rows.push_back(std::move(heading));
  const auto row_of = [&](const Picture& picture, const char* block) {
    std::vector<std::pair<std::string, Value>> values{{"view", std::string(picture.view)}};
    if (picture.time_s) values.emplace_back("scene.time_s", *picture.time_s);
    if (std::string_view(picture.figure) == "fig8") values.emplace_back("hulls", std::int64_t{4});
    return find_row_of(chosen, fmt::format("{}_{}", picture.figure, block), values);
  };
  for (const auto& [format, block] : {std::pair{"16-bit", "by_slices"}, std::pair{"32-bit", "by_slices_single"}}) {
    for (const auto& [metric, field] :
         {std::pair{"FLIP", "reference_to_exact_flip_mean"}, std::pair{"RMSE", "reference_to_exact_rmse"}}) {
      Numbers values;
      for (const Picture& picture : kPictures)
        values.push_back(measured(row_of(picture, block), field));
      table.rows.push_back(
          number_row(fmt::format("1,024 slices in a {} frame: {} from the exact", format, metric), values, 3));
    }
  }
  for (const auto& [by, block] :
       {std::pair{"the exact reference", "hulls"}, std::pair{"1,024 slices, 16-bit", "by_slices"},
        std::pair{"1,024 slices, 32-bit", "by_slices_single"}}) {
    Numbers values;
    for (const Picture& picture : kPictures)
      values.push_back(measured(row_of(picture, block), "flip_mean"));
    table.rows.push_back(number_row(fmt::format("The paper's hulls: FLIP by {}", by), values, 3));
  }
  for (std::size_t i = 0; i < kPictures.size(); ++i) {
    const auto at = [&](std::size_t row) { return real_value(cell_value(table.rows[row], i)); };
    TableRecord record{{"picture", std::string(kPictures[i].label)},
                       {"quantity", std::string("flip_mean of 1,024 slices from the exact reference")},
                       {"paper", std::nullopt},
                       {"ours", at(1)},
                       {"flip_mean_half", at(1)},
                       {"rmse_half", at(2)},
                       {"flip_mean_single", at(3)},
                       {"rmse_single", at(4)},
                       {"hulls_flip_mean", at(5)},
                       {"hulls_flip_mean_by_half", at(6)},
                       {"hulls_flip_mean_by_single", at(7)}};
    add_origin(record, make_place(kPictures[i].label, row_of(kPictures[i], "by_slices")), chosen.sweep);
    table.records.push_back(std::move(record));
  }
  table.notes.emplace_back(
      "FLIP (mean) and RMSE are of scene-linear images; both references have the same opaque surfaces.");
  add_provenance(table, chosen);
  return table;
}

}  // namespace pellucid::sweeps
