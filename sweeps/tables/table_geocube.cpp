// Table 2 of Chan and Wang 2005 (references.bib: chan2005), the errors of the pictures of Figs. 1, 12 and 16, and what
// each bound of Sec. 2.1 brings.
#include <cstdint>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sweeps/tables/table_places.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;

struct PublishedModel {
  const char* name;   ///< in the paper
  const char* block;  ///< of the spec: what stands in
  double triangles;
  double prepare_s;
  double cubes;
  double fps;
};
constexpr PublishedModel kTable2[] = {
    {"Venus", "head", 40e3, 249, 1, 23}, {"Bunny", "bunny", 80e3, 1085, 2, 14}, {"Isis", "statue", 28e3, 384, 2, 25}};

struct Quantity {
  const char* label;
  const char* field;
};
constexpr Quantity kErrors[] = {{"FLIP on the object", "flip_mean_mask"},
                                {"RMSE on the object", "rmse_mask"},
                                {"mean error of the exit point [diagonals]", "exit_error_mean"},
                                {"median error of the exit point [diagonals]", "exit_error_median"},
                                {"mean error of the exit direction [deg]", "exit_direction_error_deg_mean"},
                                {"share that ends before the surface", "early_share"},
                                {"share stopped by the bound", "bounded_share"},
                                {"mean steps", "steps_mean"}};

void add_error_rows(Table& table, const std::vector<Place>& places, const std::string& where) {
  for (const Quantity& quantity : kErrors) {
    table.rows.push_back(
        our_row(quantity.label + where, places, 3, [&](const json& row) { return number(row, quantity.field); }));
  }
}

void add_error_fields(TableRecord& record, const Place& place) {
  for (const char* field : {"precomputation_s", "prepare_s", "frame_ms_median", "frame_ms_ci95_low",
                            "frame_ms_ci95_high", "flip_mean", "rmse", "object_pixels"})
    record.emplace_back(field, real_field(place, field));
  for (const Quantity& quantity : kErrors)
    record.emplace_back(quantity.field, real_field(place, quantity.field));
}

void add_notes(Table& table, const ChosenRows& chosen, const std::vector<Place>& places) {
  for (std::string& note : provenance_notes(table.info, chosen))
    table.notes.push_back(std::move(note));
  if (chosen.rows.empty()) return;
  table.notes.emplace_back(
      "FLIP (mean) and RMSE are against the ray-traced picture of the same optics, over the pixels that show the "
      "object. Exits are those of the first search of a pixel against the true mesh, in diagonals of the object.");
  for (std::string& note : outcome_notes(places))
    table.notes.push_back(std::move(note));
}

/// A column of the comparison.
struct Method {
  std::string label, block;
  std::vector<std::pair<std::string, Value>> values;
};

const std::vector<Method>& methods() {
  static const std::vector<Method> all{
      {"front side", "front_refraction", {}},
      {"screen space", "screen_space_refraction", {}},
      {"refractor map", "distance_impostors", {}},
      {"1 cube, middle", "middle", {}},
      {"1 cube, by hand", "hand", {{"cubes", std::int64_t{1}}}},
      {"2 cubes, by hand", "hand", {{"cubes", std::int64_t{2}}}},
      {"1 cube", "automatic", {{"cubes", std::int64_t{1}}}},
      {"2 cubes", "automatic", {{"cubes", std::int64_t{2}}}},
      {"5 cubes", "automatic", {{"cubes", std::int64_t{5}}}},
      {"1 cube, 4 layers", "layers", {}},
  };
  return all;
}

}  // namespace

TableInfo geocube_table2_info() {
  return {.name = "geocube.table2",
          .title = "Precomputation time and frame rate at 512 × 512",
          .source = "Chan and Wang 2005, Table 2",
          .spec = "geocube_table2"};
}

Table geocube_table2(const TableInfo& info, const ChosenRows& chosen) {
  Table table{.info = info, .rows = {}, .heading_rows = 2, .records = {}, .notes = {}, .sweep = chosen.sweep};
  std::vector<Place> places;
  std::vector<std::string> names, stand_ins;
  std::vector<std::optional<double>> triangles, prepare, cubes, rates;
  for (const PublishedModel& model : kTable2) {
    places.push_back(make_place(model.block, find_row_of(chosen, model.block, {})));
    names.emplace_back(model.name);
    stand_ins.emplace_back(model.block);
    triangles.emplace_back(model.triangles);
    prepare.emplace_back(model.prepare_s);
    cubes.emplace_back(model.cubes);
    rates.emplace_back(model.fps);
  }
  table.rows.push_back(words_row("Model (paper)", names));
  table.rows.push_back(words_row("Ours in its place", stand_ins));
  table.rows.push_back(paper_row("triangles (paper)", 0, triangles));
  table.rows.push_back(
      our_row("triangles (ours)", places, 5, [](const json& row) { return number(row, "object_triangles"); }));
  table.rows.push_back(paper_row("cubes (paper)", 0, cubes));
  table.rows.push_back(our_row("cubes (ours)", places, 1, [](const json& row) { return number(row, "cubes_placed"); }));
  table.rows.push_back(paper_row("precomputation [s] (paper)", 0, prepare));
  table.rows.push_back(
      our_row("precomputation [s] (ours)", places, 3, [](const json& row) { return number(row, "precomputation_s"); }));
  table.rows.push_back(paper_row("fps (paper)", 0, rates));
  table.rows.push_back(fps_row("fps (ours)", places));
  for (TableRow& row : interval_rows(places))
    table.rows.push_back(std::move(row));
  add_error_rows(table, places, "");
  table.rows.push_back(outcome_row(places));
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (const auto& [quantity, paper, ours] :
         {std::tuple{"fps", rates[i], fps(places[i])},
          std::tuple{"precomputation_s", prepare[i],
                     places[i].measured() ? number(*places[i].row, "precomputation_s") : std::nullopt}}) {
      TableRecord record{{"model", names[i]},
                         {"stand_in", stand_ins[i]},
                         {"quantity", std::string(quantity)},
                         {"paper", real_value(paper)},
                         {"ours", real_value(ours)}};
      add_error_fields(record, places[i]);
      add_origin(record, places[i], chosen.sweep);
      table.records.push_back(std::move(record));
    }
  }
  table.notes.push_back(
      fmt::format("Paper: {}: Pentium 4 3 GHz, GeForce 6800, 512 × 512, 64×64×6 cubes.", info.source));
  add_notes(table, chosen, places);
  return table;
}

TableInfo geocube_fig16_info() {
  return {.name = "geocube.fig16",
          .title = "Figs. 1, 12 and 16: ways to refract, against ray tracing",
          .source = "Chan and Wang 2005, Figs. 1, 12 and 16",
          .spec = "geocube_figures"};
}

Table geocube_fig16(const TableInfo& info, const ChosenRows& chosen) {
  Table table{.info = info, .rows = {}, .heading_rows = 1, .records = {}, .notes = {}, .sweep = chosen.sweep};
  std::vector<std::string> labels;
  for (const Method& method : methods())
    labels.push_back(method.label);
  table.rows.push_back(words_row("Method", labels));
  std::vector<Place> everywhere;
  for (const char* scene : {"glass_head", "glass_bunny", "glass_torus"}) {
    std::vector<Place> places;
    bool any = false;
    for (const Method& method : methods()) {
      auto values = method.values;
      values.emplace_back("scene", std::string(scene));
      const json* row = find_row_of(chosen, method.block, values);
      places.push_back(make_place(fmt::format("{}, {}", scene, method.label), row));
      any = any || row != nullptr;
    }
    if (!any && !chosen.rows.empty()) continue;  // a preview has fewer scenes
    const std::string where = fmt::format(", {}", scene);
    add_error_rows(table, places, where);
    table.rows.push_back(fps_row("fps (ours)" + where, places));
    for (std::size_t i = 0; i < places.size(); ++i) {
      TableRecord record{{"scene", std::string(scene)},
                         {"method", labels[i]},
                         {"quantity", std::string("flip_mean_mask")},
                         {"paper", std::nullopt},
                         {"ours", real_field(places[i], "flip_mean_mask")},
                         {"fps", real_field(places[i], "fps")}};
      add_error_fields(record, places[i]);
      add_origin(record, places[i], chosen.sweep);
      table.records.push_back(std::move(record));
    }
    everywhere.insert(everywhere.end(), places.begin(), places.end());
  }
  table.notes.push_back(fmt::format("Paper: {}: pictures alone, no errors.", info.source));
  add_notes(table, chosen, everywhere);
  return table;
}

TableInfo geocube_bounds_info() {
  return {.name = "geocube.bounds",
          .title = "What cones A, B and C and sphere D bring",
          .source = "Chan and Wang 2005, Sec. 2.1",
          .spec = "geocube_curves"};
}

Table geocube_bounds(const TableInfo& info, const ChosenRows& all) {
  const ChosenRows chosen = rows_of_blocks(all, {"bounds"});
  Table table{.info = info, .rows = {}, .heading_rows = 1, .records = {}, .notes = {}, .sweep = chosen.sweep};
  struct Set {
    const char* cones;
    const char* label;
  };
  static constexpr Set kSets[] = {{"none", ""},   {"a", "A"},     {"b", "B"},     {"c", "C"},
                                  {"ab", "A, B"}, {"ac", "A, C"}, {"bc", "B, C"}, {"abc", "A, B, C"}};
  static constexpr Quantity kShown[] = {{"mean exit error [diagonals]", "exit_error_mean"},
                                        {"ends early", "early_share"},
                                        {"bounded", "bounded_share"},
                                        {"mean steps", "steps_mean"},
                                        {"FLIP on the object", "flip_mean_mask"}};
  std::vector<std::string> heading;
  for (const Quantity& quantity : kShown)
    heading.emplace_back(quantity.label);
  heading.emplace_back("fps");
  table.rows.push_back(words_row("Bounds used", heading));
  std::vector<Place> everywhere;
  for (const std::string scene : {"glass_bunny", "glass_torus"}) {
    std::vector<Place> places;
    std::vector<std::string> names;
    bool any = false;
    for (const Set& set : kSets) {
      for (const bool sphere : {false, true}) {
        const json* row =
            find_row_of(chosen, "bounds", {{"scene", scene}, {"cones", std::string(set.cones)}, {"sphere", sphere}});
        std::string label = set.label;
        if (sphere) label += label.empty() ? "D" : ", D";
        names.push_back(label.empty() ? "none, δ alone" : label);
        places.push_back(make_place(fmt::format("{}: {}", scene, names.back()), row));
        any = any || row != nullptr;
      }
    }
    if (!any && !chosen.rows.empty()) continue;  // a preview has fewer scenes
    // A row for each set of bounds: the quantities' rows turned by a quarter.
    std::vector<TableRow> quantities;
    for (const Quantity& quantity : kShown)
      quantities.push_back(our_row("", places, 3, [&](const json& row) { return number(row, quantity.field); }));
    quantities.push_back(fps_row("", places));
    for (std::size_t i = 0; i < places.size(); ++i) {
      TableRow row{places[i].name, {}, TableRow::all};
      for (TableRow& quantity : quantities)
        row.cells.push_back(std::move(quantity.cells[i]));
      table.rows.push_back(std::move(row));
      TableRecord record{{"bounds", names[i]},
                         {"quantity", std::string("exit_error_mean")},
                         {"paper", std::nullopt},
                         {"ours", real_field(places[i], "exit_error_mean")},
                         {"fps", real_field(places[i], "fps")}};
      add_error_fields(record, places[i]);
      add_origin(record, places[i], chosen.sweep);
      table.records.push_back(std::move(record));
    }
    everywhere.insert(everywhere.end(), places.begin(), places.end());
  }
  table.notes.push_back(fmt::format("Paper: {}: no numbers.", info.source));
  add_notes(table, chosen, everywhere);
  return table;
}

}  // namespace pellucid::sweeps
