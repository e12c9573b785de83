#include "plots/figures/shadow_figures.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "plots/charts/chart.hpp"
#include "plots/figures/row_chart.hpp"

namespace pellucid::plots {

using nlohmann::json;

std::string shadow_size_figure(const FigureInfo& info, const std::vector<json>& rows,
                               const std::vector<Condition>& conditions, const std::string& figure,
                               const std::string& field) {
  std::vector<json> chosen;
  for (const json& row : rows) {
    const std::string block = row.value("block", std::string());
    for (const char* part : {"hulls", "marching", "slices"}) {
      if (block == fmt::format("{}_{}", figure, part)) chosen.push_back(row);
    }
  }
  if (chosen.empty())
    throw InputError(
        fmt::format("nothing to draw: no row is of the blocks {0}_hulls, {0}_marching or {0}_slices", figure));
  RowChart wanted;
  wanted.x = "shadow.size";
  wanted.y = field;
  wanted.series = {"technique", "filter_occlusion"};
  wanted.log_x = true;
  wanted.conditions = conditions;
  wanted.title = info.title;
  return to_svg(chart_of_rows(chosen, wanted));
}

}  // namespace pellucid::plots
