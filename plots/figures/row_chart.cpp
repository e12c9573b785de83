#include "plots/figures/row_chart.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "plots/charts/style.hpp"

namespace pellucid::plots {
namespace {

using nlohmann::json;

/// The numeric parameter that takes the most values.
std::string widest_parameter(const std::vector<json>& rows, const RowChart& wanted) {
  std::map<std::string, std::set<double>> values;
  for (const json* row : choose_rows(rows, wanted.conditions, {}).kept) {
    for (const auto& [name, text] : settings(*row)) {
      if (const auto value = number(*row, name)) values[name].insert(*value);
    }
  }
  std::string best;
  for (const auto& [name, distinct] : values) {
    if (distinct.size() > (best.empty() ? 1 : values[best].size())) best = name;
  }
  if (best.empty())
    throw InputError("no parameter takes more than one value in these rows; name the abscissa with --x");
  return best;
}

std::string measured_field(const std::vector<json>& rows) {
  for (const char* field : {"fps", "flip_mean", "rmse"}) {
    if (std::any_of(rows.begin(), rows.end(), [&](const json& row) { return number(row, field).has_value(); })) {
      return field;
    }
  }
  throw InputError("the rows have neither fps nor flip_mean nor rmse; name what to draw with --y");
}

bool powers_of_two(const std::set<double>& values) {
  return values.size() > 1 && std::all_of(values.begin(), values.end(), [](double v) {
           int exponent = 0;
           return v > 0 && std::frexp(v, &exponent) == 0.5;
         });
}

Axis axis_of(const std::string& field) {
  static const std::map<std::string, Axis> kKnown{
      {"fps", {"frame rate", "frames/s", Scale::linear, true}},
      {"frame_ms_median", {"frame time", "ms", Scale::linear, true}},
      {"prepare_s", {"precomputation", "s", Scale::linear, true}},
      {"flip_mean", {"mean FLIP", "", Scale::linear, true}},
      {"flip_weighted_median", {"weighted median of FLIP", "", Scale::linear, true}},
      {"rmse", {"RMSE", "", Scale::linear, true}},
      {"mse", {"MSE", "", Scale::linear, true}},
      {"psnr", {"PSNR", "dB", Scale::linear, false}},
      {"ssim", {"SSIM", "", Scale::linear, false}},
      {"flip_mean_shadow", {"mean FLIP in shadows", "", Scale::linear, true}},
      {"rmse_shadow", {"RMSE in shadows", "", Scale::linear, true}},
      {"shadow.size", {"side of a shadow map", "texels", Scale::linear, false}},
      {"frame_ms_mean", {"mean frame time", "ms", Scale::linear, true}},
      {"flip_mean_mask", {"mean FLIP on the object", "", Scale::linear, true}},
      {"rmse_mask", {"RMSE on the object", "", Scale::linear, true}},
      {"hit_error_m_mean", {"mean error of the hit point", "m", Scale::linear, true}},
      {"unconverged_share", {"share of pixels that do not converge", "", Scale::linear, true}},
      {"exit_error_mean", {"mean error of the exit point", "diagonals", Scale::linear, true}},
      {"bounded_share", {"share of rays stopped by the bound", "", Scale::linear, true}},
      {"early_share", {"share of rays that end early", "", Scale::linear, true}},
      {"steps_mean", {"mean steps", "", Scale::linear, true}},
      {"resolution", {"side of a cube's face", "texels", Scale::linear, false}},
      {"epsilon", {"thickness about the tangent plane", "diagonals", Scale::linear, false}},
      {"scene.ior", {"index of refraction", "", Scale::linear, false}},
      {"iterations", {"iterations", "", Scale::linear, false}},
      {"linear_steps", {"linear steps", "", Scale::linear, false}},
      {"cube_size", {"side of a cube map's face", "texels", Scale::linear, false}},
      {"refresh_frames", {"frames from one drawing of the maps to the next", "", Scale::linear, false}},
  };
  const auto found = kKnown.find(field);
  if (found != kKnown.end()) return found->second;
  return {field, "", Scale::linear, false};
}

void add_interval(Point& point, const json& row, const std::string& field) {
  const auto between = [&](const char* low, const char* high) {
    point.low = number(row, low);
    point.high = number(row, high);
  };
  if (field == "frame_ms_median") between("frame_ms_ci95_low", "frame_ms_ci95_high");
  if (field == "flip_weighted_median") between("flip_weighted_q1", "flip_weighted_q3");
  if (field == "fps") {
    between("frame_ms_ci95_high", "frame_ms_ci95_low");
    for (std::optional<double>* end : {&point.low, &point.high}) {
      if (*end && **end > 0) *end = 1000 / **end;
    }
  }
}

std::string interval_note(const std::string& field) {
  if (field == "frame_ms_median" || field == "fps") return "Bars: 95 % interval of the median.";
  if (field == "flip_weighted_median") return "Bars: weighted quartiles.";
  return "";
}

/// The settings in which two rows differ, for the message that refuses to pool them.
std::string difference(const json& a, const json& b) {
  const auto of_a = settings(a);
  std::vector<std::string> names;
  for (const auto& [name, value] : settings(b)) {
    const bool same = std::find(of_a.begin(), of_a.end(), std::pair(name, value)) != of_a.end();
    if (!same) names.push_back(fmt::format("{} = {}", name, value));
  }
  if (!names.empty()) return fmt::format("they differ in {}", fmt::join(names, ", "));
  return "they differ in no parameter, only in what was measured or how (blocks, timing)";
}

/// Everything that varies but is not asked for as a series must not divide the rows.
std::vector<std::string> own_settings(const Rows& rows, const RowChart& wanted, const std::string& x) {
  std::vector<std::string> own{x};
  if (x == "width" || x == "height") own.emplace_back("size");
  if (wanted.series.empty()) return own;
  std::set<std::string> names;
  for (const json* row : rows.kept) {
    for (const auto& [name, value] : settings(*row))
      names.insert(name);
  }
  for (const std::string& wish : wanted.series) {
    if (names.contains(wish)) continue;
    throw InputError(
        fmt::format("--series {} is no setting of these rows; there are {}", wish, fmt::join(names, ", ")));
  }
  for (const std::string& name : names) {
    if (std::find(wanted.series.begin(), wanted.series.end(), name) == wanted.series.end()) own.push_back(name);
  }
  return own;
}

}  // namespace

Chart chart_of_rows(const std::vector<json>& rows, const RowChart& wanted) {
  const std::string x = wanted.x.empty() ? widest_parameter(rows, wanted) : wanted.x;
  const std::string y = wanted.y.empty() ? measured_field(rows) : wanted.y;
  const std::vector<std::string> fields{x, y};
  const Rows chosen = choose_rows(rows, wanted.conditions, fields);

  Chart chart;
  chart.x = axis_of(x);
  chart.y = axis_of(y);
  chart.x.from_zero = false;
  chart.title = wanted.title.empty() ? fmt::format("{} over {}", chart.y.label, chart.x.label) : wanted.title;
  std::set<double> abscissae;
  for (const json* row : chosen.kept)
    abscissae.insert(*number(*row, x));
  if (wanted.log_x || (abscissae.size() > 2 && powers_of_two(abscissae))) {
    chart.x.scale = powers_of_two(abscissae) ? Scale::log2 : Scale::log10;
  }
  if (wanted.log_y) chart.y.scale = Scale::log10;

  const std::vector<Group> groups = group_rows(chosen, own_settings(chosen, wanted, x));
  constexpr std::size_t kMost = 12;
  if (groups.size() > kMost) {
    throw InputError(fmt::format("the chart would have {} lines ('{}', '{}', …), more than {}; choose with --where",
                                 groups.size(), groups[0].label, groups[1].label, kMost));
  }
  std::set<std::string> techniques;
  for (const Group& group : groups)
    techniques.insert(group.technique);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const Group& group = groups[g];
    std::map<double, const json*> at;
    for (const json* row : group.rows) {
      const auto [place, fresh] = at.try_emplace(*number(*row, x), row);
      if (fresh) continue;
      throw InputError(
          fmt::format("several rows of '{}' stand at {} = {:g}: {}; divide with --series or choose with "
                      "--where",
                      group.label, x, place->first, difference(*place->second, *row)));
    }
    Series& series = chart.series.emplace_back();
    series.label = groups.size() > 1 ? group.label : std::string();
    // The colours of techniques tell them apart; where one technique makes every line, each line has its own.
    series.style = techniques.size() == 1 ? style(g) : technique_style(group.technique, g);
    if (techniques.size() > 1 && group.variant > 0) series.style = variant(series.style, group.variant);
    for (const auto& [abscissa, row] : at) {
      series.points.push_back({abscissa, *number(*row, y), {}, {}});
      add_interval(series.points.back(), *row, y);
    }
  }
  const bool timed = y == "fps" || y.starts_with("frame_ms") || x == "fps" || x.starts_with("frame_ms");
  chart.note = provenance_note(chosen, timed);
  if (groups.size() == 1 && !groups[0].label.empty()) chart.note = fmt::format("{}; {}", groups[0].label, chart.note);
  if (const std::string bars = interval_note(y); !bars.empty()) chart.note += " " + bars;
  return chart;
}

}  // namespace pellucid::plots
