#include "plots/figures/figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/parameters.hpp"
#include "gl/error.hpp"
#include "plots/charts/chart.hpp"
#include "plots/charts/style.hpp"
#include "plots/figures/plane_map.hpp"
#include "plots/figures/row_figures.hpp"
#include "plots/figures/rows.hpp"
#include "plots/figures/shadow_figures.hpp"

namespace pellucid::plots {
namespace {

using nlohmann::json;

/// Volume samples along a ray: M·N for hulls, N for ray marching, the count for slices.
std::optional<double> budget(const json& row) {
  const std::string technique = row.value("technique", std::string());
  if (technique == "sampling_hulls") {
    const auto hulls = number(row, "hulls"), samples = number(row, "samples");
    if (!hulls || !samples) return std::nullopt;
    return *hulls * *samples;
  }
  if (technique == "ray_marching") return number(row, "samples");
  if (technique == "volume_slices") return number(row, "slices");
  return std::nullopt;
}

const std::vector<std::string> kBudgetSettings{"hulls", "samples", "slices"};

Rows with_budget(Rows rows) {
  std::erase_if(rows.kept, [](const json* row) { return !budget(*row); });
  if (rows.kept.empty()) {
    throw InputError("nothing to draw: no row is of sampling_hulls, ray_marching or volume_slices");
  }
  return rows;
}

/// Rows that an axis to base 10 can show; the others are counted in `dropped`.
Rows positive(Rows rows, const std::string& field, std::size_t& dropped) {
  dropped = std::erase_if(rows.kept, [&](const json* row) { return *number(*row, field) <= 0; });
  if (rows.kept.empty()) throw InputError(fmt::format("nothing to draw: every row has {} = 0", field));
  return rows;
}

std::string joined(std::initializer_list<std::string> sentences) {
  std::string text;
  for (const std::string& sentence : sentences) {
    if (!sentence.empty()) text += (text.empty() ? "" : " ") + sentence;
  }
  return text;
}

/// A scale that suits positive values: to base 10 when they span more than a factor of ten.
Scale scale_for(double least, double greatest) {
  return least > 0 && greatest > 10 * least ? Scale::log10 : Scale::linear;
}

void check_series_count(const Chart& chart) {
  constexpr std::size_t kMost = 10;
  const auto labelled =
      std::count_if(chart.series.begin(), chart.series.end(), [](const Series& s) { return !s.label.empty(); });
  if (labelled > static_cast<std::ptrdiff_t>(kMost)) {
    throw InputError(fmt::format("chart '{}' would have {} lines ('{}', '{}', …), more than {}; choose with --where",
                                 chart.title, labelled, chart.series[0].label, chart.series[1].label, kMost));
  }
}

Point fps_point(double x, const json& row) {
  Point point{x, *number(row, "fps"), {}, {}};
  const auto low = number(row, "frame_ms_ci95_low"), high = number(row, "frame_ms_ci95_high");
  if (high && *high > 0) point.low = 1000 / *high;
  if (low && *low > 0) point.high = 1000 / *low;
  return point;
}

/// FPS over M, a line for each M·N.
std::string fps_figure(const FigureInfo& info, const Rows& rows) {
  std::map<double, std::vector<Group>> lines;
  const std::vector<Group> groups = group_rows(rows, kBudgetSettings);
  check_distinct(groups, kBudgetSettings);
  for (const Group& group : groups) {
    std::map<double, Group> parts;
    for (const json* row : group.rows) {
      Group& part = parts[*budget(*row)];
      part.label = groups.size() > 1 ? ", " + group.label : std::string();
      part.rows.push_back(row);
    }
    for (auto& [product, part] : parts)
      lines[product].push_back(std::move(part));
  }
  Chart chart;
  chart.title = info.title;
  chart.x = {"sampling hulls M", "", Scale::log2, false};
  double least = HUGE_VAL, greatest = 0;
  std::size_t index = 0;
  for (const auto& [product, parts] : lines) {
    for (const Group& part : parts) {
      Series& series = chart.series.emplace_back();
      series.label = fmt::format("M·N = {:g}{}", product, part.label);
      series.style = style(index++);
      for (const json* row : part.rows)
        series.points.push_back(fps_point(*number(*row, "hulls"), *row));
      std::sort(series.points.begin(), series.points.end(), [](const Point& a, const Point& b) { return a.x < b.x; });
      for (const Point& point : series.points) {
        least = std::min(least, point.y);
        greatest = std::max(greatest, point.y);
      }
    }
  }
  check_series_count(chart);
  const Scale scale = scale_for(least, greatest);
  chart.y = {"frame rate", "frames/s", scale, scale == Scale::linear};
  chart.note = joined({provenance_note(rows, true), "Bars: 95 % interval of the median."});
  return to_svg(chart);
}

/// The mean may lie below both quartiles: they are of the error's mass, not of the pixels.
void add_quartiles(Point& point, const json& row, const std::string& field) {
  if (field != "flip_mean") return;
  point.low = number(row, "flip_weighted_q1");
  point.high = number(row, "flip_weighted_q3");
}

Color faint(const Color& color) {
  const auto mix = [](std::uint8_t v) { return static_cast<std::uint8_t>((v + 3 * 255) / 4); };
  return {mix(color.r), mix(color.g), mix(color.b)};
}

/// The series of a technique: `shown` joined, `others` as faint markers without an entry in the legend.
void add_technique(Chart& chart, const Group& group, std::vector<Point> shown, std::vector<Point> others,
                   std::size_t index, double shift_px) {
  Style look = technique_style(group.technique, index);
  if (group.variant > 0) look = variant(look, group.variant);
  if (!others.empty()) {
    chart.series.push_back({"", std::move(others), {faint(look.color), look.marker, Line::none}, shift_px});
  }
  chart.series.push_back({group.label, std::move(shown), look, shift_px});
}

std::string zero_note(std::size_t dropped) {
  if (dropped == 0) return "";
  return fmt::format("{} without any error left out.", dropped == 1 ? "1 point" : fmt::format("{} points", dropped));
}

/// How exact the reference is: errors below that mean nothing.
std::string reference_note(const Rows& rows) {
  double mean = 0, most = 0;
  for (const json* row : rows.kept) {
    mean = std::max(mean, number(*row, "reference_step_error_mean").value_or(0));
    most = std::max(most, number(*row, "reference_step_error_max").value_or(0));
  }
  if (most <= 0) return "";
  return fmt::format(" The reference's own step error: {:.1e} in the mean, {:.1e} at most.", mean, most);
}

/// Error over the number of volume samples along a ray.
std::string error_figure(const FigureInfo& info, const Rows& all, const std::string& field, const Axis& axis) {
  std::size_t dropped = 0;
  const Rows rows = positive(with_budget(all), field, dropped);
  Chart chart;
  chart.title = info.title;
  chart.x = {"samples along a ray (M·N, slices)", "", Scale::log2, false};
  chart.y = axis;
  const std::vector<Group> groups = group_rows(rows, kBudgetSettings, Labels::unusual);
  check_distinct(groups, kBudgetSettings);
  bool chosen = false;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::map<double, const json*> best;
    for (const json* row : groups[g].rows) {
      const json*& kept = best[*budget(*row)];
      if (kept == nullptr || *number(*row, field) < *number(*kept, field)) kept = row;
    }
    std::vector<Point> shown, others;
    for (const auto& [product, row] : best) {
      shown.push_back({product, *number(*row, field), {}, {}});
      add_quartiles(shown.back(), *row, field);
    }
    for (const json* row : groups[g].rows) {
      if (best.at(*budget(*row)) != row) others.push_back({*budget(*row), *number(*row, field), {}, {}});
    }
    chosen |= !others.empty();
    // Bars at one abscissa would hide each other.
    const double shift =
        field == "flip_mean" ? 6 * (static_cast<double>(g) - (static_cast<double>(groups.size()) - 1) / 2) : 0;
    add_technique(chart, groups[g], std::move(shown), std::move(others), g, shift);
  }
  check_series_count(chart);
  chart.note =
      joined({provenance_note(rows, false),
              field == "flip_mean"
                  ? "Bars: quartiles of FLIP weighted by itself, which the mean may lie below; moved sideways to stay "
                    "apart."
                  : "",
              chosen ? "Joined: the best M×N of each product; faint: the others." : "",
              usual_note(rows, kBudgetSettings), zero_note(dropped)});
  if (field == "rmse") chart.note += reference_note(rows);
  return to_svg(chart);
}

/// Error against the time of a frame.
std::string error_time_figure(const FigureInfo& info, const Rows& all) {
  std::size_t dropped = 0;
  const Rows rows = positive(with_budget(all), "flip_mean", dropped);
  Chart chart;
  chart.title = info.title;
  chart.x = {"frame time", "ms", Scale::log10, false};
  chart.y = {"mean FLIP", "", Scale::log10, false};
  const std::vector<Group> groups = group_rows(rows, kBudgetSettings, Labels::unusual);
  check_distinct(groups, kBudgetSettings);
  bool chosen = false;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<std::pair<double, Point>> points;
    std::set<double> budgets;
    for (const json* row : groups[g].rows) {
      points.push_back({*budget(*row), {*number(*row, "frame_ms_median"), *number(*row, "flip_mean"), {}, {}}});
      budgets.insert(*budget(*row));
    }
    std::vector<Point> shown, others;
    if (budgets.size() == points.size()) {
      std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
      for (const auto& [samples, point] : points)
        shown.push_back(point);
    } else {
      // Several M×N make one product: join what no other setting beats in both time and error.
      std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
        return a.second.x != b.second.x ? a.second.x < b.second.x : a.second.y < b.second.y;
      });
      for (const auto& [samples, point] : points)
        (shown.empty() || point.y < shown.back().y ? shown : others).push_back(point);
      chosen |= !others.empty();
    }
    add_technique(chart, groups[g], std::move(shown), std::move(others), g, 0);
  }
  check_series_count(chart);
  chart.note =
      joined({provenance_note(rows, true), chosen ? "Joined: settings that none beats in both; faint: the others." : "",
              usual_note(rows, kBudgetSettings), zero_note(dropped)});
  return to_svg(chart);
}

struct Figure {
  FigureInfo info;
  /// The SVG of the rows that meet the conditions.
  std::function<std::string(const FigureInfo&, const std::vector<json>&, const std::vector<Condition>&)> draw;

  Figure(FigureInfo described, std::vector<std::string> fields,
         std::string (*draw_rows)(const FigureInfo&, const Rows&))
      : info(std::move(described)),
        draw([fields = std::move(fields), draw_rows](const FigureInfo& about, const std::vector<json>& rows,
                                                     const std::vector<Condition>& conditions) {
          return draw_rows(about, choose_rows(rows, conditions, fields));
        }) {}
  /// Over the size of the shadow maps, in one of the paper's figures.
  Figure(FigureInfo described, std::string figure, std::string field)
      : info(std::move(described)),
        draw([figure = std::move(figure), field = std::move(field)](
                 const FigureInfo& about, const std::vector<json>& rows, const std::vector<Condition>& conditions) {
          return shadow_size_figure(about, rows, conditions, figure, field);
        }) {}
  explicit Figure(const RowFigure& figure)
      : info(figure.info),
        draw([chart = figure.chart](const FigureInfo& about, const std::vector<json>& rows,
                                    const std::vector<Condition>& conditions) {
          RowChart wanted = chart;
          wanted.title = about.title;
          wanted.conditions.insert(wanted.conditions.end(), conditions.begin(), conditions.end());
          return to_svg(chart_of_rows(rows, wanted));
        }) {}
};

const std::vector<Figure>& all_figures() {
  static const std::string kShadows = "sampling_hulls_shadows";
  static const std::vector<Figure> kFigures = [] {
    std::vector<Figure> all{
        {{"sampling_hulls.fps", "Frame rate over the number of sampling hulls",
          "frame rate over M, a line for each number of points M·N", "sampling_hulls_curves"},
         {"hulls", "samples", "fps"},
         fps_figure},
        {{"sampling_hulls.fps_map", "Frame rate over hulls and points",
          "frame rate on the plane of M and N, the paper's choice 4×8 and ours marked", "sampling_hulls_curves"},
         {"hulls", "samples", "fps"},
         [](const FigureInfo& info, const Rows& rows) { return plane_map(info, rows, "fps"); }},
        {{"sampling_hulls.error_map", "Perceived error over hulls and points",
          "mean FLIP on the plane of M and N, the paper's choice 4×8 and ours marked", "sampling_hulls_curves"},
         {"hulls", "samples", "fps", "flip_mean"},
         [](const FigureInfo& info, const Rows& rows) { return plane_map(info, rows, "flip_mean"); }},
        {{"sampling_hulls.error", "Perceived error over the number of samples",
          "mean FLIP over M·N, with weighted quartiles, for hulls and their baselines", "sampling_hulls_curves"},
         {"flip_mean"},
         [](const FigureInfo& info, const Rows& rows) {
           return error_figure(info, rows, "flip_mean", {"mean FLIP", "", Scale::log10, false});
         }},
        {{"sampling_hulls.rmse", "RMSE over the number of samples",
          "root of the mean squared error of radiance over M·N, for hulls and their baselines",
          "sampling_hulls_curves"},
         {"rmse"},
         [](const FigureInfo& info, const Rows& rows) {
           return error_figure(info, rows, "rmse", {"RMSE of radiance", "", Scale::log10, false});
         }},
        {{"sampling_hulls.error_time", "Perceived error against frame time",
          "mean FLIP against the time of a frame, for hulls and their baselines", "sampling_hulls_curves"},
         {"flip_mean", "frame_ms_median"},
         error_time_figure},
        {{"sampling_hulls.shadow_error_fig10", "Fig. 10: error in the shadows over the size of the shadow maps",
          "mean FLIP where the medium lies in shadow over the texels along a shadow map's side, with averaged "
          "occlusion "
          "rates and without",
          kShadows},
         "fig10",
         "flip_mean_shadow"},
        {{"sampling_hulls.shadow_error_fig11", "Fig. 11: error in the shadows over the size of the shadow map",
          "mean FLIP where the medium lies in shadow over the texels along the shadow map's side, with averaged "
          "occlusion rates and without",
          kShadows},
         "fig11",
         "flip_mean_shadow"},
        {{"sampling_hulls.shadow_time_fig10", "Fig. 10: frame time over the size of the shadow maps",
          "time of a frame over the texels along a shadow map's side, with averaged occlusion rates and without",
          kShadows},
         "fig10",
         "frame_ms_median"},
        {{"sampling_hulls.shadow_time_fig11", "Fig. 11: frame time over the size of the shadow map",
          "time of a frame over the texels along the shadow map's side, with averaged occlusion rates and without",
          kShadows},
         "fig11",
         "frame_ms_median"},
    };
    for (const RowFigure& figure : row_figures())
      all.emplace_back(figure);
    return all;
  }();
  return kFigures;
}

const Figure& find(std::string_view name) {
  std::vector<std::string> names;
  for (const Figure& figure : all_figures()) {
    if (figure.info.name == name) return figure;
    names.push_back(figure.info.name);
  }
  const std::string near = nearest_name(name, names);
  throw InputError(fmt::format(
      "unknown figure '{}'; {}", name,
      near.empty() ? fmt::format("there are {}", fmt::join(names, ", ")) : fmt::format("did you mean '{}'?", near)));
}

}  // namespace

std::vector<FigureInfo> figures() {
  std::vector<FigureInfo> result;
  for (const Figure& figure : all_figures())
    result.push_back(figure.info);
  return result;
}

FigureInfo find_figure(std::string_view name) {
  return find(name).info;
}

void write_figure(std::string_view name, const std::vector<json>& rows, const std::filesystem::path& path,
                  std::span<const Condition> conditions) {
  const Figure& figure = find(name);
  check_chart_path(path);
  std::vector<Condition> all(conditions.begin(), conditions.end());
  const bool chosen =
      std::any_of(all.begin(), all.end(), [](const Condition& condition) { return condition.field == "sweep"; });
  for (const std::string& sweep : {figure.info.spec, figure.info.spec + "_preview"}) {
    if (chosen) break;
    const bool there = std::any_of(rows.begin(), rows.end(),
                                   [&](const json& row) { return row.value("sweep", std::string()) == sweep; });
    if (!there) continue;
    all.insert(all.begin(), {"sweep", sweep});
    break;
  }
  write_svg_as(figure.draw(figure.info, rows, all), path);
}

}  // namespace pellucid::plots
