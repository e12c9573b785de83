// Figs. 8 to 11 of Imagire et al. 2007 (references.bib: imagire2007): the frame rates that captions and Sec. 5 name.
#include <cassert>
#include <cstdint>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sweeps/tables/table_places.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;

/// A column: a picture of the figure, or a setting that the text names.
struct Column {
  const char* label;  ///< "(a)"
  const char* view;   ///< of our scene
  std::optional<double> time_s;
  int hulls = 0, samples = 0;    ///< of ours …
  int slices = 0;                ///< … or the slices' count
  std::optional<double> fps{};   ///< the paper's
  std::optional<int> against{};  ///< the column of the slices that it is compared with
};

struct PublishedFigure {
  int number;
  const char* title;
  std::vector<Column> columns;
};

const PublishedFigure& published(int number) {
  static const std::vector<PublishedFigure> all{
      {8,
       "a foggy forest",
       {{.label = "(a)", .view = "path", .time_s = {}, .hulls = 2, .samples = 4},
        {.label = "(b)", .view = "path", .time_s = {}, .hulls = 4, .samples = 8, .fps = 64, .against = 3},
        {.label = "(c)", .view = "path", .time_s = {}, .slices = 128},
        {.label = "text", .view = "path", .time_s = {}, .slices = 512, .fps = 26}}},
      {9,
       "a water tank",
       {{.label = "(a)", .view = "front", .time_s = {}, .hulls = 2, .samples = 8, .fps = 96, .against = 3},
        {.label = "(b)", .view = "above", .time_s = {}, .hulls = 2, .samples = 8, .fps = 96, .against = 2},
        {.label = "(c)", .view = "above", .time_s = {}, .slices = 64, .fps = 96},
        {.label = "", .view = "front", .time_s = {}, .slices = 64}}},
      {10,
       "a teapot in a room with two spotlights",
       {{.label = "(a)", .view = "front", .time_s = 0, .hulls = 4, .samples = 4, .fps = 82, .against = 2},
        {.label = "(b)", .view = "front", .time_s = 5, .hulls = 4, .samples = 4, .fps = 82, .against = 3},
        {.label = "(c)", .view = "front", .time_s = 0, .slices = 32, .fps = 68},
        {.label = "", .view = "front", .time_s = 5, .slices = 32}}},
      {11,
       "a statue with a moving spotlight",
       {{.label = "(a)", .view = "front", .time_s = {}, .hulls = 8, .samples = 8, .fps = 77, .against = 1},
        {.label = "(b)", .view = "front", .time_s = {}, .slices = 64, .fps = 203},
        {.label = "(c)", .view = "shadow", .time_s = {}, .hulls = 8, .samples = 8, .fps = 77, .against = 3},
        {.label = "(d)", .view = "shadow", .time_s = {}, .slices = 64, .fps = 203}}},
  };
  for (const PublishedFigure& figure : all) {
    if (figure.number == number) return figure;
  }
  assert(false && "a figure of pictures that the paper lacks");
  return all.front();
}

std::string method(const Column& column) {
  return column.slices > 0 ? fmt::format("{} slices", column.slices)
                           : fmt::format("{} × {} hulls", column.hulls, column.samples);
}

std::vector<std::pair<std::string, Value>> values_of(const Column& column) {
  std::vector<std::pair<std::string, Value>> values{{"view", std::string(column.view)}};
  if (column.time_s) values.emplace_back("scene.time_s", *column.time_s);
  if (column.slices > 0) {
    values.emplace_back("slices", std::int64_t{column.slices});
  } else {
    values.emplace_back("hulls", std::int64_t{column.hulls});
    values.emplace_back("samples", std::int64_t{column.samples});
  }
  return values;
}

/// The frame rate over that of the slices it is compared with.
std::optional<double> ratio(std::optional<double> rate, std::optional<double> of_slices) {
  return rate && of_slices && *of_slices > 0 ? std::optional(*rate / *of_slices) : std::nullopt;
}

bool any(const TableRow& row) {
  for (const TableCell& cell : row.cells) {
    if (!cell.text.empty()) return true;
  }
  return false;
}

/// The table in the making.
class FigureTable {
 public:
  FigureTable(int number, const TableInfo& info, const ChosenRows& all)
      : figure_(published(number)), chosen_(rows_of_blocks(all, {fmt::format("fig{}_", number)})) {
    table_.info = info;
    table_.heading_rows = 2;
    table_.sweep = chosen_.rows.empty() ? "" : chosen_.sweep;
    for (const Column& column : figure_.columns) {
      const std::string block = fmt::format("fig{}_{}", number, column.slices > 0 ? "slices" : "hulls");
      const std::string name = fmt::format("{}{}{}", column.label, *column.label == '\0' ? "" : " ", method(column));
      places_.push_back(make_place(name, find_row_of(chosen_, block, values_of(column))));
      by_slices_.push_back(column.slices > 0
                               ? nullptr
                               : find_row_of(chosen_, fmt::format("fig{}_by_slices", number), values_of(column)));
    }
  }

  Table make() {
    add_headings();
    add_rates();
    add_errors();
    table_.rows.push_back(outcome_row(places_));
    for (std::size_t i = 0; i < places_.size(); ++i)
      table_.records.push_back(record(i));
    add_notes();
    return std::move(table_);
  }

 private:
  std::optional<double> paper_ratio(std::size_t i) const {
    const Column& column = figure_.columns[i];
    if (!column.against) return std::nullopt;
    return ratio(column.fps, figure_.columns[static_cast<std::size_t>(*column.against)].fps);
  }
  std::optional<double> our_ratio(std::size_t i) const {
    const Column& column = figure_.columns[i];
    if (!column.against) return std::nullopt;
    return ratio(fps(places_[i]), fps(places_[static_cast<std::size_t>(*column.against)]));
  }
  std::optional<double> by_slices(std::size_t i, const char* field) const {
    return by_slices_[i] != nullptr && outcome(by_slices_[i]) != "failed" ? number(*by_slices_[i], field)
                                                                          : std::nullopt;
  }

  void add_headings() {
    std::vector<std::string> labels, methods, views;
    for (const Column& column : figure_.columns) {
      labels.emplace_back(column.label);
      methods.push_back(method(column));
      views.push_back(column.time_s ? fmt::format("{}, {} s", column.view, *column.time_s) : column.view);
    }
    table_.rows.push_back(words_row("Picture", labels));
    table_.rows.push_back(words_row("Method", methods));
    table_.rows.push_back(words_row("Our view", views));
  }

  void add_rates() {
    std::vector<std::optional<double>> rates, paper_ratios, our_ratios;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      rates.push_back(figure_.columns[i].fps);
      paper_ratios.push_back(paper_ratio(i));
      our_ratios.push_back(our_ratio(i));
    }
    table_.rows.push_back(paper_row("fps (paper)", 0, rates));
    table_.rows.push_back(fps_row("fps (ours)", places_));
    for (TableRow& row : interval_rows(places_))
      table_.rows.push_back(std::move(row));
    table_.rows.push_back(paper_row("fps over the slices' (paper)", 2, paper_ratios));
    table_.rows.push_back(value_row("fps over the slices' (ours)", places_, 2, our_ratios));
  }

  void add_errors() {
    for (const auto& [label, field] :
         {std::pair{"FLIP", "flip_mean"}, std::pair{"RMSE", "rmse"}, std::pair{"FLIP in shadows", "flip_mean_shadow"},
          std::pair{"RMSE in shadows", "rmse_shadow"}}) {
      TableRow row = our_row(label, places_, 3, [&](const json& r) { return number(r, field); });
      if (any(row) || !std::string_view(label).ends_with("shadows")) table_.rows.push_back(std::move(row));
    }
    for (const auto& [label, field] :
         {std::pair{"FLIP by 1,024 slices", "flip_mean"}, std::pair{"RMSE by 1,024 slices", "rmse"}}) {
      TableRow row{label, {}, TableRow::all};
      for (std::size_t i = 0; i < places_.size(); ++i) {
        const auto value = by_slices(i, field);
        row.cells.push_back({value ? significant(*value, 3) : "", value});
      }
      if (any(row)) table_.rows.push_back(std::move(row));  // a preview does not judge every figure so
    }
  }

  TableRecord record(std::size_t i) const {
    const Column& column = figure_.columns[i];
    const Place& place = places_[i];
    const auto bound = [&](const char* frame_ms) {
      return place.measured() ? real_value(fps_bound(*place.row, frame_ms)) : std::nullopt;
    };
    const auto count = [](int n) { return n > 0 ? std::optional<Value>(std::int64_t{n}) : std::nullopt; };
    TableRecord out{{"figure", std::int64_t{figure_.number}},
                    {"picture", std::string(column.label)},
                    {"technique", std::string(column.slices > 0 ? "volume_slices" : "sampling_hulls")},
                    {"hulls", count(column.hulls)},
                    {"samples", count(column.samples)},
                    {"slices", count(column.slices)},
                    {"time_s", real_value(column.time_s)},
                    {"quantity", std::string("fps")},
                    {"paper", real_value(column.fps)},
                    {"ours", real_value(fps(place))},
                    {"ours_ci95_low", bound("frame_ms_ci95_high")},
                    {"ours_ci95_high", bound("frame_ms_ci95_low")},
                    {"paper_over_slices", real_value(paper_ratio(i))},
                    {"ours_over_slices", real_value(our_ratio(i))}};
    for (const char* field :
         {"frame_ms_median", "flip_mean", "rmse", "flip_mean_shadow", "rmse_shadow", "shadow_pixels_share"})
      out.emplace_back(field, real_field(place, field));
    out.emplace_back("flip_mean_by_slices", real_value(by_slices(i, "flip_mean")));
    out.emplace_back("rmse_by_slices", real_value(by_slices(i, "rmse")));
    add_origin(out, place, chosen_.sweep);
    return out;
  }

  void add_notes() {
    table_.notes.push_back(fmt::format(
        "Paper: {}: GeForce 7800 GTX, Pentium D 3.2 GHz, DirectX 9, 720 × 540, 16-bit floats; no errors are given.",
        table_.info.source));
    for (std::string& note : provenance_notes(table_.info, chosen_))
      table_.notes.push_back(std::move(note));
    if (chosen_.rows.empty()) return;
    table_.notes.emplace_back(
        "FLIP (mean) and RMSE are of the scene-linear image against the exact reference of the same opaque surfaces; "
        "by "
        "1,024 slices: against the paper's own kind of reference, in its frame format.");
    std::optional<double> share;
    for (const Place& place : places_) {
      if (place.measured() && !share) share = number(*place.row, "shadow_pixels_share");
    }
    if (share && *share > 0) {
      table_.notes.push_back(fmt::format(
          "In shadows: where the shadows in the medium take more than 5 % of the pixel's luminance, {:.1f} % of "
          "the first picture.",
          100 * *share));
    }
    for (std::string& note : outcome_notes(places_))
      table_.notes.push_back(std::move(note));
  }

  const PublishedFigure& figure_;
  ChosenRows chosen_;
  std::vector<Place> places_;
  std::vector<const json*> by_slices_;
  Table table_{};
};

}  // namespace

TableInfo sampling_hulls_figure_info(int n) {
  return {.name = fmt::format("sampling_hulls.fig{}", n),
          .title = fmt::format("Fig. {}, {}: hulls against slices at the paper's counts", n, published(n).title),
          .source = fmt::format("Imagire et al. 2007, Fig. {} and Sec. 5", n),
          .spec = "sampling_hulls_figures"};
}

Table sampling_hulls_fig8(const TableInfo& info, const ChosenRows& chosen) {
  return FigureTable(8, info, chosen).make();
}
Table sampling_hulls_fig9(const TableInfo& info, const ChosenRows& chosen) {
  return FigureTable(9, info, chosen).make();
}
Table sampling_hulls_fig10(const TableInfo& info, const ChosenRows& chosen) {
  return FigureTable(10, info, chosen).make();
}
Table sampling_hulls_fig11(const TableInfo& info, const ChosenRows& chosen) {
  return FigureTable(11, info, chosen).make();
}

}  // namespace pellucid::sweeps
