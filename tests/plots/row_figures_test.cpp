// Figures that are data: their specs measure what they draw.
#include "plots/figures/row_figures.hpp"

#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sweeps/spec/spec.hpp"

namespace pellucid::plots {
namespace {

bool varies(const sweeps::RunBlock& block, const std::string& name) {
  if (name == "scene") return block.scenes.size() > 1;
  if (name == "technique") return block.techniques.size() > 1;
  return std::any_of(block.axes.begin(), block.axes.end(),
                     [&](const sweeps::Axis& axis) { return axis.name == name && axis.values.size() > 1; });
}

TEST(RowFigures, SpecsMeasureWhatTheyDraw) {
  for (const RowFigure& figure : row_figures()) {
    const std::string& name = figure.info.name;
    for (const std::string& spec_name : {figure.info.spec, figure.info.spec + "_preview"}) {
      const sweeps::Spec spec = sweeps::load_spec(spec_name);
      std::size_t drawn = 0;
      for (const sweeps::RunBlock& block : spec.blocks) {
        const auto condition = std::find_if(figure.chart.conditions.begin(), figure.chart.conditions.end(),
                                            [](const Condition& c) { return c.field == "block"; });
        if (condition != figure.chart.conditions.end() && condition->value != block.name) continue;
        if (!varies(block, figure.chart.x)) continue;
        ++drawn;
        const std::string& y = figure.chart.y;
        if (y.starts_with("frame_ms") || y == "fps") {
          EXPECT_TRUE(block.timing.enabled) << name;
        }
        if (y.starts_with("flip") || y.starts_with("rmse")) {
          const std::string metric = y.substr(0, 4);
          EXPECT_NE(std::find(block.metrics.begin(), block.metrics.end(), metric), block.metrics.end()) << name;
        }
        // Everything else that varies must divide the rows or be chosen, or points would be pooled.
        for (const sweeps::Axis& axis : block.axes) {
          const bool told = axis.name == figure.chart.x ||
                            std::count(figure.chart.series.begin(), figure.chart.series.end(), axis.name) > 0 ||
                            std::any_of(figure.chart.conditions.begin(), figure.chart.conditions.end(),
                                        [&](const Condition& c) { return c.field == axis.name; });
          EXPECT_TRUE(told || axis.values.size() == 1) << name << ' ' << axis.name;
        }
      }
      EXPECT_GT(drawn, 0U) << name << " draws no block of " << spec_name;
    }
  }
}

TEST(RowFigures, DrawTheirBlockAlone) {
  const auto row = [](const char* block, int iterations, const char* scheme, double flip) {
    return nlohmann::json{{"point", std::string(block) + scheme + std::to_string(iterations)},
                          {"sweep", "distance_impostors_curves"},
                          {"block", block},
                          {"technique", "distance_impostors"},
                          {"scene", "mirror_room"},
                          {"view", "front"},
                          {"width", 480},
                          {"height", 480},
                          {"status", "ok"},
                          {"iterations", iterations},
                          {"scheme", scheme},
                          {"flip_mean_mask", flip},
                          {"device", "d"},
                          {"driver", "v"}};
  };
  const std::vector<nlohmann::json> rows{row("iterations", 0, "secant", 0.2), row("iterations", 1, "secant", 0.1),
                                         row("iterations", 0, "linear", 0.3), row("iterations", 1, "linear", 0.2),
                                         row("cube_size", 1, "secant", 0.9)};
  const auto found = std::find_if(row_figures().begin(), row_figures().end(),
                                  [](const RowFigure& f) { return f.info.name == "distance_impostors.iterations"; });
  ASSERT_NE(found, row_figures().end());
  const RowFigure& figure = *found;
  RowChart chart = figure.chart;
  chart.series = {"scheme"};  // one scene here
  const Chart drawn = chart_of_rows(rows, chart);
  ASSERT_EQ(drawn.series.size(), 2U);
  for (const Series& series : drawn.series) {
    EXPECT_EQ(series.points.size(), 2U);
    for (const Point& point : series.points)
      EXPECT_LT(point.y, 0.9);
  }
}

}  // namespace
}  // namespace pellucid::plots
