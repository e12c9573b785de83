#include "plots/figures/figures.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "plots/charts/style.hpp"
#include "plots/figures/figure_reader.hpp"
#include "sweeps/tables/csv.hpp"

namespace pellucid::plots {
namespace {

using nlohmann::json;

std::string text_of(const std::optional<double>& value) {
  return value ? fmt::format("{}", *value) : std::string();
}

/// A column for the line, the two fields, the ends of the bar, and whether the point is joined to its neighbours.
std::string data_of(const Chart& chart) {
  const std::string& y = chart.y.field;
  std::string csv = sweeps::csv_record({"line", chart.x.field, y, y + "_low", y + "_high", "joined"});
  for (const Series& series : chart.series) {
    for (const Point& point : series.points) {
      csv += sweeps::csv_record({series.name, text_of(point.x), text_of(point.y), text_of(point.low),
                                 text_of(point.high), series.style.line == Line::none ? "false" : "true"});
    }
  }
  return csv;
}

std::string data_of(const HeatMap& map, const PlaneMap& wanted) {
  std::string csv = sweeps::csv_record({wanted.x.field, wanted.y.field, wanted.value.field, "mark"});
  for (std::size_t row = 0; row < map.rows.size(); ++row) {
    for (std::size_t column = 0; column < map.columns.size(); ++column) {
      if (!map.values[row][column]) continue;
      std::vector<std::string> marks;
      for (const HeatMap::Mark& mark : map.marks) {
        if (mark.cell.row == row && mark.cell.column == column) marks.push_back(mark.label);
      }
      csv += sweeps::csv_record({map.columns[column], map.rows[row], text_of(map.values[row][column]),
                                 fmt::format("{}", fmt::join(marks, " "))});
    }
  }
  return csv;
}

Drawn draw(const RowChart& wanted, const std::vector<json>& rows, const Fields& fields) {
  const Chart chart = chart_of_rows(rows, wanted, fields);
  return {to_svg(chart), data_of(chart)};
}

Drawn draw(const PlaneMap& wanted, const std::vector<json>& rows, const Fields& fields) {
  const HeatMap map = map_of_rows(rows, wanted, fields);
  return {to_svg(map), data_of(map, wanted)};
}

}  // namespace

std::vector<Figure> read_figures(const sweeps::PaperPointer& paper) {
  std::vector<Figure> figures;
  for (const std::string& name : sweeps::entry_names(*paper, "figures"))
    figures.push_back(read_figure({paper, name}));
  return figures;
}

std::vector<Figure> built_in_figures() {
  std::vector<Figure> figures;
  for (const sweeps::PaperPointer& paper : sweeps::papers()) {
    for (Figure& figure : read_figures(paper))
      figures.push_back(std::move(figure));
  }
  return figures;
}

Figure find_figure(std::string_view name) {
  return read_figure(sweeps::find_entry(name, "figures", "figure"));
}

Drawn draw_figure(const Figure& figure, const std::vector<json>& rows, std::span<const Where> where) {
  if (const auto* slabs = std::get_if<SlabChart>(&figure.drawing)) {
    if (!where.empty())
      throw InputError(fmt::format("figure '{}' is worked out: it has no rows to choose", figure.name));
    const Chart chart = chart_of_slabs(*slabs);
    return {to_svg(chart), data_of(chart)};
  }
  const Fields fields(figure.paper.get());
  const auto chosen_rows = [&](auto drawing) {
    std::vector<Where> conditions;
    const bool chosen = std::any_of(where.begin(), where.end(), [](const Where& w) { return w.field == "sweep"; });
    const sweeps::SweepRows own = sweeps::rows_of_sweep(rows, figure.sweep);
    if (!chosen && !own.rows.empty()) conditions.push_back({"sweep", {own.sweep}});
    conditions.insert(conditions.end(), drawing.where.begin(), drawing.where.end());
    conditions.insert(conditions.end(), where.begin(), where.end());
    drawing.where = std::move(conditions);
    return draw(drawing, rows, fields);
  };
  if (const auto* map = std::get_if<PlaneMap>(&figure.drawing)) return chosen_rows(*map);
  return chosen_rows(std::get<RowChart>(figure.drawing));
}

Drawn draw_chart(const RowChart& wanted, const std::vector<json>& rows) {
  return draw(wanted, rows, Fields());
}

}  // namespace pellucid::plots
