// Figs. 5 to 7 of Szirmay-Kalos et al. 2005 (references.bib: szirmaykalos2005), which print pictures beside ray tracing
// and no numbers in the text: ours are the errors of those pictures.
#include <cassert>
#include <cstdint>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sweeps/tables/table_places.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;
using Values = std::vector<std::pair<std::string, Value>>;

/// A column: one way to draw the object.
struct Method {
  std::string label;
  std::string technique;
  Values values;
  std::string block_suffix;  ///< behind the figure's name
};

Method classical(const char* label, const char* parallax) {
  return {label, "environment_map", {{"parallax", std::string(parallax)}}, "_environment_map"};
}

Method impostors(std::int64_t iterations) {
  return {fmt::format("NITER {}", iterations), "distance_impostors", {{"iterations", iterations}}, ""};
}

Method stepped(std::int64_t steps) {
  return {fmt::format("{} steps, NITER 2", steps), "distance_impostors", {{"linear_steps", steps}}, "_steps"};
}

std::vector<Method> reflections() {
  std::vector<Method> all{classical("classical", "none"), classical("box", "box"), classical("sphere", "sphere")};
  for (std::int64_t n = 0; n <= 3; ++n)
    all.push_back(impostors(n));
  return all;
}

std::vector<Method> reflections_past_a_box() {
  std::vector<Method> all = reflections();
  for (const std::int64_t steps : {4, 8})
    all.push_back(stepped(steps));
  return all;
}

std::vector<Method> refractions() {
  std::vector<Method> all{classical("classical", "none")};
  for (std::int64_t bounces = 1; bounces <= 2; ++bounces) {
    for (std::int64_t n = 0; n <= 1; ++n) {
      all.push_back({fmt::format("{}, NITER {}", bounces == 1 ? "single" : "double", n),
                     "distance_impostors",
                     {{"bounces", bounces}, {"iterations", n}},
                     ""});
    }
  }
  return all;
}

/// Where the object stands: one set of rows.
struct Stand {
  std::string label;  ///< empty when there is one only
  Values values;
};

struct PublishedFigure {
  int number;
  const char* title;
  std::vector<Method> methods;
  std::vector<Stand> stands;
};

const PublishedFigure& published(int number) {
  static const std::vector<PublishedFigure> all{
      {5,
       "a mirror ball moved about a room",
       reflections(),
       {{"in the middle", {{"scene.ball_x", 0.0}}},
        {"off-centre", {{"scene.ball_x", 1.6}}},
        {"in a corner", {{"scene.ball_x", 2.7}}}}},
      {6, "the room with a box that hides a part of it", reflections_past_a_box(), {{"", {}}}},
      {7, "refraction by a ball", refractions(), {{"", {}}}},
  };
  for (const PublishedFigure& figure : all) {
    if (figure.number == number) return figure;
  }
  assert(false && "a figure that the paper lacks");
  return all.front();
}

struct Quantity {
  const char* label;
  const char* field;
};
constexpr Quantity kQuantities[] = {
    {"FLIP on the object", "flip_mean_mask"},     {"RMSE on the object", "rmse_mask"},
    {"FLIP of the frame", "flip_mean"},           {"mean error of the hit [m]", "hit_error_m_mean"},
    {"share not converged", "unconverged_share"}, {"share of hits hidden from the reference point", "hidden_share"}};

// Fig. 6's residual: which hits are wrong and why, and how much of the picture's error is theirs.
constexpr Quantity kResidual[] = {{"share of hits: right", "hits_right_share"},
                                  {"share of hits: on another surface", "hits_other_surface_share"},
                                  {"share of hits: hidden", "hits_hidden_share"},
                                  {"share of hits: on no surface", "hits_unconverged_share"},
                                  {"part of the hits' error: right", "hits_right_error_share"},
                                  {"part of the hits' error: on another surface", "hits_other_surface_error_share"},
                                  {"part of the hits' error: hidden", "hits_hidden_error_share"},
                                  {"part of the hits' error: on no surface", "hits_unconverged_error_share"},
                                  {"part of FLIP: right", "flip_share_right"},
                                  {"part of FLIP: on another surface", "flip_share_other_surface"},
                                  {"part of FLIP: hidden", "flip_share_hidden"},
                                  {"part of FLIP: on no surface", "flip_share_unconverged"}};

Table figure_table(int figure_number, const TableInfo& info, const ChosenRows& all) {
  const PublishedFigure& figure = published(figure_number);
  const std::string prefix = fmt::format("fig{}", figure_number);
  const ChosenRows chosen = rows_of_blocks(all, {prefix});
  Table table{.info = info, .rows = {}, .heading_rows = 1, .records = {}, .notes = {}, .sweep = chosen.sweep};
  if (chosen.rows.empty()) table.sweep.clear();

  std::vector<std::string> labels;
  for (const Method& method : figure.methods)
    labels.push_back(method.label);
  table.rows.push_back(words_row("Method", labels));

  std::vector<Place> everywhere;
  for (const Stand& stand : figure.stands) {
    std::vector<Place> places;
    for (const Method& method : figure.methods) {
      Values values = method.values;
      values.insert(values.end(), stand.values.begin(), stand.values.end());
      const std::string name = stand.label.empty() ? method.label : fmt::format("{}, {}", method.label, stand.label);
      places.push_back(make_place(name, find_row_of(chosen, prefix + method.block_suffix, values)));
    }
    const std::string where = stand.label.empty() ? "" : ", " + stand.label;
    std::vector<Quantity> quantities(std::begin(kQuantities), std::end(kQuantities));
    if (figure_number == 6) quantities.insert(quantities.end(), std::begin(kResidual), std::end(kResidual));
    for (const Quantity& quantity : quantities) {
      table.rows.push_back(
          our_row(quantity.label + where, places, 3, [&](const json& row) { return number(row, quantity.field); }));
    }
    table.rows.push_back(fps_row("fps (ours)" + where, places));
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Place& place = places[i];
      TableRecord record{{"figure", std::int64_t{figure_number}},
                         {"method", figure.methods[i].label},
                         {"technique", figure.methods[i].technique},
                         {"stand", stand.label.empty() ? std::nullopt : std::optional<Value>(stand.label)},
                         {"quantity", std::string("flip_mean_mask")},
                         {"paper", std::nullopt},
                         {"ours", real_field(place, "flip_mean_mask")}};
      for (const char* field :
           {"rmse_mask", "flip_mean", "rmse", "hit_error_m_mean", "hit_error_m_median", "direction_error_deg_median",
            "unconverged_share", "hidden_share", "fps", "frame_ms_median", "frame_ms_ci95_low", "frame_ms_ci95_high"})
        record.emplace_back(field, real_field(place, field));
      if (figure_number == 6) {
        for (const Quantity& quantity : kResidual)
          record.emplace_back(quantity.field, real_field(place, quantity.field));
      }
      add_origin(record, place, table.sweep);
      table.records.push_back(std::move(record));
    }
    everywhere.insert(everywhere.end(), places.begin(), places.end());
  }

  table.notes.push_back(
      fmt::format("Paper: {}: NV6800GT, 700 × 700; it compares pictures and names no errors.", info.source));
  for (std::string& note : provenance_notes(info, chosen))
    table.notes.push_back(std::move(note));
  if (!chosen.rows.empty()) {
    table.notes.emplace_back(
        "FLIP (mean) and RMSE are against the ray-traced scene; on the object: over the pixels that show it. Box and "
        "sphere: Bjorke's proxies, beyond the paper. Not converged: |l| / |l'| more than 1 % off 1.");
    if (figure_number == 6) {
      table.notes.emplace_back(
          "Right: seen from the reference point in the direction of the true hit, to two texels; on another surface: "
          "converged, off the true hit's plane; hidden: the reference point does not see the true hit; on no surface: "
          "the "
          "rest. Steps: linear search before false position, beyond the paper; NITER 2 fetches 4 times, with n steps "
          "n + 3 times.");
    }
    for (std::string& note : outcome_notes(everywhere))
      table.notes.push_back(std::move(note));
  }
  return table;
}

/// A frame rate that the paper names, and the block that measures ours.
struct PublishedRate {
  const char* figure;
  const char* what;
  const char* block;
  std::optional<double> low, high;  ///< the same where one number is given
};
const std::vector<PublishedRate>& rates() {
  static const std::vector<PublishedRate> all{
      {"Fig. 10", "caustic", "fig10", 182, 182},     {"Fig. 11", "through the ball", "fig11", {}, {}},
      {"Fig. 12", "skull", "fig12_skull", 130, 130}, {"Fig. 12", "teapot", "fig12_teapot", 440, 440},
      {"Fig. 13", "box", "fig13", 160, 160},         {"Fig. 14", "armour", "fig14", 105, 130},
      {"Fig. 15", "balls", "fig15", 85, 105},
  };
  return all;
}

}  // namespace

TableInfo distance_impostors_rates_info() {
  return {.name = "distance_impostors.rates",
          .title = "Frame rates that Figs. 10 to 15 name",
          .source = "Szirmay-Kalos et al. 2005, Figs. 10 to 15",
          .spec = "distance_impostors_scenes"};
}

Table distance_impostors_rates(const TableInfo& info, const ChosenRows& chosen) {
  Table table{.info = info, .rows = {}, .heading_rows = 2, .records = {}, .notes = {}, .sweep = chosen.sweep};
  TableRow figures{"Figure", {}, TableRow::all}, scenes{"Scene", {}, TableRow::all},
      paper{"fps (paper)", {}, TableRow::all};
  std::vector<Place> places;
  for (const PublishedRate& rate : rates()) {
    figures.cells.push_back({rate.figure, std::nullopt});
    scenes.cells.push_back({rate.what, std::nullopt});
    const bool range = rate.low != rate.high;
    paper.cells.push_back({!rate.low ? ""
                           : range   ? fmt::format("{:g} to {:g}", *rate.low, *rate.high)
                                     : fmt::format("{:g}", *rate.low),
                           range ? std::nullopt : rate.low});
    places.push_back(make_place(fmt::format("{}, {}", rate.figure, rate.what), find_row_of(chosen, rate.block, {})));
  }
  table.rows = {std::move(figures), std::move(scenes), std::move(paper), fps_row("fps (ours)", places)};
  for (TableRow& row : interval_rows(places))
    table.rows.push_back(std::move(row));
  for (const auto& [label, field] : {std::pair{"FLIP", "flip_mean"}, std::pair{"FLIP on the objects", "flip_mean_mask"},
                                     std::pair{"caustic energy over the photon tracer's", "caustic_energy_ratio"}}) {
    table.rows.push_back(our_row(label, places, 3, [&](const json& row) { return number(row, field); }));
  }
  table.rows.push_back(outcome_row(places));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const PublishedRate& rate = rates()[i];
    TableRecord record{
        {"figure", std::string(rate.figure)}, {"object", std::string(rate.what)},
        {"quantity", std::string("fps")},     {"paper", rate.low == rate.high ? real_value(rate.low) : std::nullopt},
        {"paper_low", real_value(rate.low)},  {"paper_high", real_value(rate.high)},
        {"ours", real_value(fps(places[i]))}};
    for (const char* field :
         {"frame_ms_median", "frame_ms_mean", "flip_mean", "flip_mean_mask", "rmse", "caustic_energy_ratio", "cube_ms"})
      record.emplace_back(field, real_field(places[i], field));
    add_origin(record, places[i], chosen.sweep);
    table.records.push_back(std::move(record));
  }
  table.notes.push_back(fmt::format(
      "Paper: {}: NV6800GT, P4 3 GHz; the size of these frames is not named, ours is that of Fig. 5.", info.source));
  for (std::string& note : provenance_notes(info, chosen))
    table.notes.push_back(std::move(note));
  if (!chosen.rows.empty()) {
    table.notes.emplace_back(
        "FLIP (mean) is against the ray-traced scene, with photon-traced caustics in Figs. 10 and 11.");
    for (std::string& note : outcome_notes(places))
      table.notes.push_back(std::move(note));
  }
  return table;
}

TableInfo distance_impostors_figure_info(int n) {
  return {.name = fmt::format("distance_impostors.fig{}", n),
          .title = fmt::format("Fig. {}, {}: environment mapping and distance impostors against ray tracing", n,
                               published(n).title),
          .source = fmt::format("Szirmay-Kalos et al. 2005, Fig. {}", n),
          .spec = "distance_impostors_figures"};
}

Table distance_impostors_fig5(const TableInfo& info, const ChosenRows& chosen) {
  return figure_table(5, info, chosen);
}
Table distance_impostors_fig6(const TableInfo& info, const ChosenRows& chosen) {
  return figure_table(6, info, chosen);
}
Table distance_impostors_fig7(const TableInfo& info, const ChosenRows& chosen) {
  return figure_table(7, info, chosen);
}

}  // namespace pellucid::sweeps
