// Figures that are data: what each shows of stored rows, and what their files must say.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <span>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "algorithms/scattering/slab.hpp"
#include "gl/error.hpp"
#include "plots/figures/figures.hpp"
#include "sweeps/quantities/quantities.hpp"
#include "sweeps/spec/spec.hpp"
#include "tests/input_error.hpp"
#include "tests/temporary_folder.hpp"

namespace pellucid::plots {
namespace {

using nlohmann::json;

/// A file of one figure, with more keys.
sweeps::PaperPointer paper_of(const std::string& figure) {
  return sweeps::parse_paper(R"(title = "Mine"
sweeps = ["sampling_hulls_curves"]
[quantities.product]
label = "M·N"
doc = "all points"
expression = "hulls * samples"
[[figures]]
name = "f"
title = "A figure"
doc = "what it shows"
sweep = "sampling_hulls_curves"
)" + figure,
                             "my.toml");
}

std::string error_of(const std::string& figure) {
  return test::input_error([&] { read_figures(paper_of(figure)); });
}

json row(int hulls, int samples, double ms, double flip, const char* extra = "half") {
  return {{"point", std::to_string(hulls) + "x" + std::to_string(samples) + extra},
          {"sweep", "sampling_hulls_curves"},
          {"block", "b"},
          {"technique", "sampling_hulls"},
          {"scene", "fog_forest"},
          {"view", "path"},
          {"width", 72},
          {"height", 54},
          {"status", "ok"},
          {"hulls", hulls},
          {"samples", samples},
          {"frame.format", extra},
          {"frame_ms_median", ms},
          {"frame_ms_ci95_low", ms - 1},
          {"frame_ms_ci95_high", ms + 1},
          {"fps", 1000 / ms},
          {"flip_mean", flip},
          {"timing", "converged"},
          {"clock", "finish"},
          {"device", "d"},
          {"driver", "v"}};
}

const std::vector<json> kRows{row(1, 2, 10, 0.5), row(2, 1, 8, 0.6), row(2, 2, 16, 0.2), row(4, 1, 20, 0.1)};

Chart chart_of(const std::string& figure, const std::vector<json>& rows = kRows) {
  const Figure read = read_figures(paper_of(figure)).at(0);
  return chart_of_rows(rows, std::get<RowChart>(read.drawing), Fields(read.paper.get()));
}

std::vector<std::pair<double, double>> points(const Series& series) {
  std::vector<std::pair<double, double>> out;
  for (const Point& point : series.points)
    out.emplace_back(point.x, point.y);
  return out;
}
using Points = std::vector<std::pair<double, double>>;

TEST(PaperFigures, EachValueOfAQuantityIsALine) {
  const Chart chart = chart_of("x = 'hulls'\ny = 'fps'\nlines = 'product'\n");
  ASSERT_EQ(chart.series.size(), 2U);
  EXPECT_EQ(chart.series[0].label, "M·N = 2");
  EXPECT_EQ(points(chart.series[0]), (Points{{1, 100}, {2, 125}}));
  EXPECT_EQ(points(chart.series[1]), (Points{{2, 62.5}, {4, 50}}));
  EXPECT_DOUBLE_EQ(chart.series[0].points[0].low.value(), 1000.0 / 11);
  EXPECT_DOUBLE_EQ(chart.series[0].points[0].high.value(), 1000.0 / 9);
}

TEST(PaperFigures, BestOfEachProductIsJoinedAndTheOthersShow) {
  const Chart chart = chart_of("x = 'product'\ny = { field = 'flip_mean', scale = 'log' }\njoin = 'best'\n");
  ASSERT_EQ(chart.series.size(), 2U);
  EXPECT_EQ(points(chart.series[0]), (Points{{2, 0.6}, {4, 0.2}})) << "faint";
  EXPECT_EQ(chart.series[0].style.line, Line::none);
  EXPECT_EQ(points(chart.series[1]), (Points{{2, 0.5}, {4, 0.1}}));
  // The best of rates is the highest.
  EXPECT_EQ(points(chart_of("x = 'product'\ny = 'fps'\njoin = 'best'\n").series[1]), (Points{{2, 125}, {4, 62.5}}));
}

TEST(PaperFigures, TheFrontIsWhatNoneBeatsInBoth) {
  std::vector<json> rows = kRows;
  rows.push_back(row(1, 4, 18, 0.3));  // slower than 2×2 and no better
  const std::string front = "x = 'frame_ms_median'\ny = 'flip_mean'\njoin = 'front'\norder_by = 'product'\n";
  const Chart chart = chart_of(front, rows);
  ASSERT_EQ(chart.series.size(), 2U);
  EXPECT_EQ(points(chart.series[0]), (Points{{18, 0.3}}));
  EXPECT_EQ(points(chart.series[1]), (Points{{8, 0.6}, {10, 0.5}, {16, 0.2}, {20, 0.1}}));
  // Each product once: all are joined in its order, better or not.
  const std::vector<json> once{row(2, 2, 5, 0.9), row(1, 2, 10, 0.5), row(4, 4, 12, 0.7)};
  EXPECT_EQ(points(chart_of(front, once).series.at(0)), (Points{{10, 0.5}, {5, 0.9}, {12, 0.7}}));
}

TEST(PaperFigures, ALogarithmicAxisLeavesOutZerosAndSaysSo) {
  std::vector<json> rows = kRows;
  rows[3]["flip_mean"] = 0.0;
  const Chart chart = chart_of("x = 'product'\ny = { field = 'flip_mean', scale = 'log' }\njoin = 'best'\n", rows);
  EXPECT_EQ(points(chart.series.back()), (Points{{2, 0.5}, {4, 0.2}}));
  EXPECT_NE(chart.note.find("1 point at 0 left out"), std::string::npos) << chart.note;
}

TEST(PaperFigures, WhereChoosesByOneValueOrByAList) {
  std::vector<json> rows = kRows;
  rows.push_back(row(1, 2, 30, 0.9, "single"));
  rows.push_back(row(1, 2, 40, 0.9, "mixed"));
  const std::string keys = "x = 'hulls'\ny = 'fps'\nlines = 'product'\n";
  EXPECT_EQ(chart_of(keys + "where = { frame.format = 'half' }\n", rows).series.size(), 2U);
  EXPECT_EQ(chart_of(keys + "where = { frame.format = ['half', 'single'], samples = 2 }\n", rows).series.size(), 3U);
}

TEST(PaperFigures, MarksOfAMapAreChosenByWhatTheySay) {
  const std::string plane = R"(x = { field = "hulls", label = "M" }
y = { field = "samples", label = "N" }
value = "fps"
needs = ["flip_mean"]
[[figures.marks]]
label = "theirs"
at = { hulls = 2, samples = 2 }
note = "Theirs."
[[figures.marks]]
label = "ours"
best = "fps"
no_worse_in = "flip_mean"
than = "theirs"
note = "Ours: {hulls}×{samples}, held to {bound}."
)";
  const Figure figure = read_figures(paper_of(plane)).at(0);
  const auto draw = [&](const std::vector<json>& rows) {
    return map_of_rows(rows, std::get<PlaneMap>(figure.drawing), Fields(figure.paper.get()));
  };
  HeatMap map = draw(kRows);
  ASSERT_EQ(map.marks.size(), 2U);
  EXPECT_EQ(map.columns, (std::vector<std::string>{"1", "2", "4"}));
  EXPECT_EQ(map.values[1][1], 62.5);
  EXPECT_EQ(map.marks[1].cell.column, 1U) << "2×2 itself: what is faster errs more";
  EXPECT_NE(map.note.find("Ours: 2×2, held to 0.2."), std::string::npos) << map.note;
  std::vector<json> faster = kRows;
  faster[3]["fps"] = 63;
  map = draw(faster);
  EXPECT_EQ(map.marks[1].cell.column, 2U);
  faster.erase(faster.begin() + 2);
  EXPECT_TRUE(draw(faster).marks.empty()) << "without theirs there is nothing to hold the others to";
  const Drawn drawn = draw_figure(figure, kRows);
  EXPECT_NE(drawn.csv.find("2,2,62.5,theirs ours"), std::string::npos) << drawn.csv;
}

TEST(PaperFigures, MistakesAreToldWithTheirPlace) {
  EXPECT_EQ(error_of("x = 'hulls'\n").substr(0, 8), "my.toml:");
  EXPECT_EQ(error_of("x = 'hulls'\ny = 'fps'\njoni = 'best'\n").substr(0, 13), "my.toml:14:1:");
  EXPECT_EQ(error_of("x = 'hulls'\ny = 'fps'\njoin = 'bets'\n").substr(0, 13), "my.toml:14:8:");
  EXPECT_EQ(error_of("x = 'hulls'\ny = 'flip_maen'\n").substr(0, 13), "my.toml:13:5:");
  EXPECT_NE(error_of("x = 'hulls'\ny = 'flip_maen'\n").find("'flip_mean'"), std::string::npos);
  EXPECT_EQ(error_of("x = 'hulls'\ny = { field = 'fps', scale = 'lgo' }\n").substr(0, 14), "my.toml:13:30:");
  EXPECT_EQ(error_of("x = 'hulls'\ny = 'fps'\nbars = ['flip_mean']\n").substr(0, 13), "my.toml:14:8:");
  EXPECT_EQ(error_of("x = 'hulls'\ny = 'fps'\njoin = 'front'\n").substr(0, 8), "my.toml:");
  EXPECT_EQ(error_of("x = 'hulls'\ny = 'samples'\nvalue = 'fps'\n[[figures.marks]]\nlabel = 'a'\nbest = 'fps'\n"
                     "no_worse_in = 'flip_mean'\nthan = 'b'\n")
                .substr(0, 13),
            "my.toml:19:8:");
}

/// A file of one figure that needs no sweep.
sweeps::PaperPointer slab_paper(const std::string& slab) {
  return sweeps::parse_paper("title = 'Mine'\n[[figures]]\nname = 'f'\ntitle = 'A figure'\nslab = " + slab + "\n",
                             "my.toml");
}

TEST(PaperFigures, SlabsAreWorkedOutWithoutRows) {
  const scattering::SlabLight light = scattering::Slab({0.8, 0.9}, kSlabOrdinates).light(2);
  for (const bool polar : {false, true}) {
    const Figure figure = read_figures(slab_paper(fmt::format(
        "{{ depths = [1, 2], anisotropy = 0.8, albedo = 0.9, show = 'reflection', polar = {} }}", polar)))[0];
    const Chart chart = chart_of_slabs(std::get<SlabChart>(figure.drawing));
    ASSERT_EQ(chart.series.size(), 2U);
    // Radiances are those of the slab, whatever the coordinates: their sum over the ordinates, on both sides if polar.
    double sum = 0, expected = 0;
    for (const Point& point : chart.series[1].points)
      sum += polar ? std::hypot(point.x, point.y) : point.y;
    for (const double radiance : light.reflection)
      expected += polar ? 2 * radiance : radiance;
    EXPECT_NEAR(sum, expected, 1e-12);
    EXPECT_NE(draw_figure(figure, {}).csv.find("τ = 2"), std::string::npos);
    const Where where{"technique", {"geocube"}};
    EXPECT_THROW(draw_figure(figure, {}, std::span(&where, 1)), InputError);
  }
  for (const char* bad :
       {"{ anisotropy = 0.8 }", "{ depths = [], anisotropy = 0.8 }", "{ depths = [-1], anisotropy = 0.8 }",
        "{ depths = [1], anisotropy = 1 }", "{ depths = [1], anisotropy = 0, albedo = 2 }"})
    EXPECT_THROW(read_figures(slab_paper(bad)), InputError) << bad;
}

const std::filesystem::path kStored = std::filesystem::path(PELLUCID_SOURCE_DIR) / "tests/plots";

/// rows/SWEEP.jsonl: what the program measured before figures were data; figures/NAME.csv: the numbers that it drew.
TEST(PaperFigures, DrawWhatTheProgramDrewBeforeTheyWereData) {
  std::size_t compared = 0;
  for (const auto& file : std::filesystem::directory_iterator(kStored / "figures")) {
    const Figure figure = find_figure(file.path().stem().string());
    std::vector<json> rows;
    std::istringstream lines(test::read_file(kStored / "rows" / (figure.sweep + ".jsonl")));
    for (std::string line; std::getline(lines, line);)
      rows.push_back(json::parse(line));
    EXPECT_EQ(draw_figure(figure, rows).csv, test::read_file(file.path())) << figure.full_name;
    ++compared;
  }
  EXPECT_EQ(compared, 26U);
}

bool varies(const sweeps::RunBlock& block, const std::string& name) {
  if (name == "scene") return block.scenes.size() > 1;
  if (name == "technique") return block.techniques.size() > 1;
  return std::any_of(block.axes.begin(), block.axes.end(),
                     [&](const sweeps::Axis& axis) { return axis.name == name && axis.values.size() > 1; });
}

bool chooses(const std::vector<Where>& where, const sweeps::RunBlock& block) {
  const auto found = std::find_if(where.begin(), where.end(), [](const Where& w) { return w.field == "block"; });
  return found == where.end() ||
         std::find(found->values.begin(), found->values.end(), block.name) != found->values.end();
}

/// In full and as a preview.
TEST(PaperFigures, SpecsMeasureWhatTheyDraw) {
  const std::vector<Figure> all = built_in_figures();
  EXPECT_GE(all.size(), 26U);
  for (const Figure& figure : all) {
    const auto* chart = std::get_if<RowChart>(&figure.drawing);
    if (chart == nullptr || chart->join != Join::all) continue;
    for (const std::string& spec_name : {figure.sweep, figure.sweep + "_preview"}) {
      sweeps::Spec spec;
      try {
        spec = sweeps::load_spec(spec_name);
      } catch (const InputError& error) {
        // Its scenes need assets that are not here.
        ASSERT_NE(std::string(error.what()).find("./bootstrap assets"), std::string::npos) << error.what();
        continue;
      }
      std::size_t drawn = 0;
      for (const sweeps::RunBlock& block : spec.blocks) {
        // An x that is measured, as a share of the picture, is spread by the axis that no series tells.
        const bool measured = sweeps::find_quantity(chart->x.field) != nullptr;
        if (!chooses(chart->where, block) || (!measured && !varies(block, chart->x.field))) continue;
        ++drawn;
        const std::string& y = chart->y.field;
        if (y.starts_with("flip") || y.starts_with("rmse")) {
          const std::string metric = y.substr(0, 4);
          EXPECT_NE(std::find(block.metrics.begin(), block.metrics.end(), metric), block.metrics.end())
              << figure.full_name;
        }
        // Everything else that varies must divide the rows or be chosen, or points would be pooled.
        if (!chart->lines.empty()) continue;
        std::size_t untold = 0;
        for (const sweeps::Axis& axis : block.axes) {
          const bool told = axis.name == chart->x.field ||
                            std::count(chart->series.begin(), chart->series.end(), axis.name) > 0 ||
                            std::any_of(chart->where.begin(), chart->where.end(),
                                        [&](const Where& w) { return w.field == axis.name; });
          if (!told && axis.values.size() > 1) ++untold;
        }
        EXPECT_EQ(untold, measured ? 1U : 0U) << figure.full_name << ' ' << block.name;
      }
      EXPECT_GT(drawn, 0U) << figure.full_name << " draws no block of " << spec_name;
    }
  }
}

}  // namespace
}  // namespace pellucid::plots
