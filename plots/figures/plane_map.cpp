#include "plots/figures/plane_map.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "plots/charts/chart.hpp"

namespace pellucid::plots {
namespace {

using nlohmann::json;

constexpr double kPaperHulls = 4, kPaperSamples = 8;  // Sec. 5: the fastest of Table 1
const std::vector<std::string> kPlane{"hulls", "samples"};

void check_one_setting(const FigureInfo& info, const Rows& rows) {
  const std::vector<Group> groups = group_rows(rows, kPlane);
  check_distinct(groups, kPlane);
  if (groups.size() < 2) return;
  throw InputError(
      fmt::format("'{}' shows one setting beside M and N, the rows have {}: '{}', '{}'{}; choose with --where",
                  info.name, groups.size(), groups[0].label, groups[1].label, groups.size() > 2 ? ", …" : ""));
}

const json* find(const Rows& rows, double hulls, double samples) {
  for (const json* row : rows.kept) {
    if (*number(*row, "hulls") == hulls && *number(*row, "samples") == samples) return row;
  }
  return nullptr;
}

/// The fastest row that errs no more than `paper`; null where a row lacks its time or its error.
const json* our_choice(const Rows& rows, const json& paper) {
  const auto bound = number(paper, "flip_mean");
  const json* best = nullptr;
  for (const json* row : rows.kept) {
    const auto error = number(*row, "flip_mean"), rate = number(*row, "fps");
    if (!bound || !error || !rate) return nullptr;
    if (*error <= *bound && (best == nullptr || *rate > *number(*best, "fps"))) best = row;
  }
  return best;
}

}  // namespace

std::string plane_map(const FigureInfo& info, const Rows& rows, const std::string& field) {
  check_one_setting(info, rows);
  std::set<double> hulls, samples;
  for (const json* row : rows.kept) {
    hulls.insert(*number(*row, "hulls"));
    samples.insert(*number(*row, "samples"));
  }
  HeatMap map;
  map.title = info.title;
  map.x_label = "sampling hulls M";
  map.y_label = "points per hull N";
  map.value_label = field == "fps" ? "frames/s" : "mean FLIP";
  for (const double m : hulls)
    map.columns.push_back(fmt::format("{:g}", m));
  for (const double n : samples)
    map.rows.push_back(fmt::format("{:g}", n));
  map.values.assign(samples.size(), std::vector<std::optional<double>>(hulls.size()));
  const auto place = [](const std::set<double>& values, double value) {
    return static_cast<std::size_t>(std::distance(values.begin(), values.find(value)));
  };
  const auto cell_of = [&](const json& row) {
    return HeatMap::Cell{place(samples, *number(row, "samples")), place(hulls, *number(row, "hulls"))};
  };
  double least = HUGE_VAL, greatest = 0;
  for (const json* row : rows.kept) {
    const double value = *number(*row, field);
    const HeatMap::Cell cell = cell_of(*row);
    map.values[cell.row][cell.column] = value;
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
  // To base 10 when the values span more than a factor of ten.
  map.value_scale = least > 0 && greatest > 10 * least ? Scale::log10 : Scale::linear;
  map.note = provenance_note(rows, true);
  if (const json* paper = find(rows, kPaperHulls, kPaperSamples)) {
    map.marks.push_back({cell_of(*paper), "paper"});
    map.note += " Solid: the paper's choice, M×N = 4×8.";
    if (const json* ours = our_choice(rows, *paper)) {
      map.marks.push_back({cell_of(*ours), "ours"});
      map.note += fmt::format(
          " Dashed: ours, {}×{}: the fastest setting whose mean FLIP is no larger than that of the paper's choice, "
          "{:.3g}.",
          value_text(ours->at("hulls")), value_text(ours->at("samples")), *number(*paper, "flip_mean"));
    }
  }
  return to_svg(map);
}

}  // namespace pellucid::plots
