#include "plots/charts/chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <fmt/format.h>
#include <vtkAxis.h>
#include <vtkBrush.h>
#include <vtkChartXY.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPen.h>
#include <vtkPlotLine.h>
#include <vtkStringArray.h>
#include <vtkTable.h>
#include <vtkTextProperty.h>

#include "gl/error.hpp"
#include "plots/charts/chart_layout.hpp"
#include "plots/charts/style.hpp"
#include "plots/charts/svg_scene.hpp"
#include "plots/charts/ticks.hpp"

namespace pellucid::plots {
namespace {

constexpr double kMarkerSize = 7;
constexpr double kLooseMarkerSize = 5.5;  ///< of points that no line joins
constexpr double kLineWidth = 1.6;
constexpr double kLegendSample = 26;  ///< length of the line in a legend entry [px]
constexpr double kLegendGap = 16;

struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

void check_value(const Chart& chart, const Series& series, std::size_t i, const Axis& axis, double value) {
  const auto place = [&] { return fmt::format("chart '{}': series '{}', point {}", chart.title, series.label, i + 1); };
  if (!std::isfinite(value)) throw InputError(fmt::format("{}: {} is not a finite number", place(), axis.label));
  if (!drawable(value, axis.scale))
    throw InputError(fmt::format("{}: {} = {} is beyond what an axis can show, {:g} to {:g}", place(), axis.label,
                                 value, kLeastShown, kMostShown));
  if (axis.scale != Scale::linear && value <= 0) {
    throw InputError(fmt::format("{}: {} = {} cannot stand on a logarithmic axis", place(), axis.label, value));
  }
}

/// The range that the axes have to show. An interval's end that a logarithmic axis cannot show does not widen it.
void extents(const Chart& chart, Extent& x, Extent& y) {
  for (const Series& series : chart.series) {
    for (std::size_t i = 0; i < series.points.size(); ++i) {
      const Point& point = series.points[i];
      check_value(chart, series, i, chart.x, point.x);
      check_value(chart, series, i, chart.y, point.y);
      x.add(point.x);
      y.add(point.y);
      for (const std::optional<double>& end : {point.low, point.high}) {
        if (!end) continue;
        if (!std::isfinite(*end) || !drawable(*end, Scale::linear)) {
          throw InputError(fmt::format("chart '{}': series '{}', point {}: an end of the interval is {}", chart.title,
                                       series.label, i + 1, *end));
        }
        if (chart.y.scale == Scale::linear || *end > 0) y.add(*end);
      }
    }
  }
  if (!(x.low <= x.high)) throw InputError(fmt::format("chart '{}' has no data", chart.title));
}

std::string axis_title(const Axis& axis) {
  return axis.unit.empty() ? axis.label : fmt::format("{} [{}]", axis.label, axis.unit);
}

/// The legend's entries in rows that fit the width.
std::vector<std::vector<const Series*>> legend_rows(const Chart& chart, double width) {
  std::vector<std::vector<const Series*>> rows;
  double used = 0;
  for (const Series& series : chart.series) {
    if (series.label.empty()) continue;
    const double entry = kLegendSample + 5 + text_width(series.label, kTickText) + kLegendGap;
    if (rows.empty() || used + entry > width + kLegendGap) {
      rows.emplace_back();
      used = 0;
    }
    rows.back().push_back(&series);
    used += entry;
  }
  return rows;
}

void paint_legend(Painter& painter, const std::vector<std::vector<const Series*>>& rows, const Frame& frame) {
  double y = frame.legend_top - kLegendRow / 2;
  for (const auto& row : rows) {
    double x = kMargin;
    for (const Series* series : row) {
      painter.line(x, y, x + kLegendSample, y, series->style.color, kLineWidth, series->style.line);
      painter.marker(x + kLegendSample / 2, y, kMarkerSize, series->style.marker, series->style.color);
      TextStyle text = kTickText;
      text.vertical = Align::centre;
      painter.text(x + kLegendSample + 5, y, series->label, text);
      x += kLegendSample + 5 + text_width(series->label, kTickText) + kLegendGap;
    }
    y -= kLegendRow;
  }
}

/// VTK draws in the plot's own pixels, not in the data's units: its SVG device keeps six digits of a coordinate after a
/// shift by the page's height, and stretches pens with the transform of the plot.
void set_axis(vtkAxis* axis, const AxisLayout& layout, double length) {
  vtkNew<vtkDoubleArray> positions;
  vtkNew<vtkStringArray> labels;
  for (const Tick& tick : layout.ticks) {
    if (tick.label.empty()) continue;  // a grid line for each minor tick would be a hatching
    positions->InsertNextValue(layout.position(tick.value) * length);
    labels->InsertNextValue(tick.label);
  }
  axis->SetBehavior(vtkAxis::FIXED);
  axis->SetRange(0, length);
  axis->SetCustomTickPositions(positions, labels);
  axis->SetTitle("");
  axis->SetTickLength(4);
  axis->SetLabelOffset(6);
  axis->GetPen()->SetColor(kInk.r, kInk.g, kInk.b);
  axis->GetPen()->SetWidth(1);
  axis->GetGridPen()->SetColor(kGrid.r, kGrid.g, kGrid.b);
  axis->GetGridPen()->SetWidth(0.8F);
  axis->GetLabelProperties()->SetFontSize(static_cast<int>(kTickText.size_px));
  axis->GetLabelProperties()->SetColor(kInk.r / 255.0, kInk.g / 255.0, kInk.b / 255.0);
}

void add_line(vtkChartXY* chart, const Series& series, const std::vector<Point>& placed) {
  vtkNew<vtkTable> table;
  vtkNew<vtkDoubleArray> x, y;
  x->SetName("x");
  y->SetName("y");
  for (const Point& point : placed) {
    x->InsertNextValue(point.x);
    y->InsertNextValue(point.y);
  }
  table->AddColumn(x);
  table->AddColumn(y);
  auto* plot = vtkPlotLine::SafeDownCast(chart->AddPlot(vtkChart::LINE));
  plot->SetInputData(table, 0, 1);
  plot->SetMarkerStyle(vtkPlotPoints::NONE);
  plot->SetColor(series.style.color.r, series.style.color.g, series.style.color.b, 255);
  plot->SetWidth(static_cast<float>(kLineWidth));
  plot->GetPen()->SetLineType(series.style.line == Line::dashed   ? vtkPen::DASH_LINE
                              : series.style.line == Line::dotted ? vtkPen::DOT_LINE
                              : series.style.line == Line::none   ? vtkPen::NO_PEN
                                                                  : vtkPen::SOLID_LINE);
}

void paint_minor_ticks(Painter& painter, const Frame& frame, const AxisLayout& x, const AxisLayout& y) {
  constexpr double kLength = 2.5;
  for (const Tick& tick : x.ticks) {
    const double at = frame.left + x.position(tick.value) * frame.width();
    if (tick.label.empty()) painter.line(at, frame.bottom, at, frame.bottom - kLength, kInk, 0.8);
  }
  for (const Tick& tick : y.ticks) {
    const double at = frame.bottom + y.position(tick.value) * frame.height();
    if (tick.label.empty()) painter.line(frame.left, at, frame.left - kLength, at, kInk, 0.8);
  }
}

void paint_interval(Painter& painter, const Frame& frame, const Point& placed, const Color& color) {
  if (!placed.low && !placed.high) return;
  const double x = frame.left + placed.x;
  const double low = frame.bottom + placed.low.value_or(placed.y);
  const double high = frame.bottom + placed.high.value_or(placed.y);
  constexpr double kCap = 2.5;
  painter.line(x, low, x, high, color, 1);
  if (placed.low && *placed.low > 0) painter.line(x - kCap, low, x + kCap, low, color, 1);
  if (placed.high) painter.line(x - kCap, high, x + kCap, high, color, 1);
}

std::string description(const Chart& chart) {
  std::string text = fmt::format("{} over {}.", axis_title(chart.y), axis_title(chart.x));
  for (const Series& series : chart.series) {
    text += fmt::format(" {}:", series.label);
    for (const Point& point : series.points)
      text += fmt::format(" ({:.5g}, {:.5g})", point.x, point.y);
    text += ".";
  }
  if (!chart.note.empty()) text += " " + chart.note;
  return text;
}

}  // namespace

std::string to_svg(const Chart& chart) {
  Extent x, y;
  extents(chart, x, y);

  const auto rows = legend_rows(chart, chart.width_px - 2 * kMargin);
  const int page_height =
      chart.height_px + std::max(0, static_cast<int>(rows.size()) - 1) * static_cast<int>(kLegendRow);
  Frame frame = outer_frame(chart.title, chart.note, chart.width_px, page_height);
  AxisLayout y_layout = lay_out_axis(chart.y, y.low, y.high, std::max(3, static_cast<int>(chart.height_px / 55)));
  double widest = 0;
  for (const Tick& tick : y_layout.ticks)
    widest = std::max(widest, text_width(tick.label, kTickText));
  frame.top -= static_cast<double>(rows.size()) * kLegendRow + (rows.empty() ? 0 : 4);
  frame.bottom += kTickText.size_px + 12 + kAxisTitleRow;
  frame.left += upright_width(frame, axis_title(chart.y)) + widest + 10;
  const AxisLayout x_layout = lay_out_axis(chart.x, x.low, x.high, std::max(4, static_cast<int>(frame.width() / 36)));
  check_frame(frame, chart.title);

  vtkNew<vtkChartXY> plot;
  plot->SetAutoSize(false);
  plot->SetLayoutStrategy(vtkChart::AXES_TO_RECT);
  plot->SetSize(vtkRectf(static_cast<float>(frame.left), static_cast<float>(frame.bottom),
                         static_cast<float>(frame.width()), static_cast<float>(frame.height())));
  plot->SetShowLegend(false);
  set_axis(plot->GetAxis(vtkAxis::BOTTOM), x_layout, frame.width());
  set_axis(plot->GetAxis(vtkAxis::LEFT), y_layout, frame.height());

  std::vector<std::vector<Point>> placed;
  for (const Series& series : chart.series) {
    std::vector<Point>& points = placed.emplace_back();
    const auto height = [&](double value) {
      const bool below = chart.y.scale != Scale::linear && value <= 0;
      return below ? 0.0 : y_layout.position(value) * frame.height();
    };
    for (const Point& point : series.points) {
      points.push_back({x_layout.position(point.x) * frame.width() + series.shift_px, height(point.y), {}, {}});
      if (point.low) points.back().low = height(*point.low);
      if (point.high) points.back().high = height(*point.high);
    }
    if (series.style.line != Line::none && points.size() > 1) add_line(plot, series, points);
  }
  // VTK draws no axes around nothing.
  if (plot->GetNumberOfPlots() == 0) {
    const Point corner{0, 0, {}, {}};
    add_line(plot, {"", {}, {chart.series.front().style.color, Marker::none, Line::none}}, {corner, corner});
  }

  SvgScene scene{chart.width_px, page_height, chart.title, description(chart), plot, {}};
  scene.paint = [&](Painter& painter) {
    paint_frame_texts(painter, frame, chart.title, chart.note, axis_title(chart.x), axis_title(chart.y));
    paint_legend(painter, rows, frame);
    paint_minor_ticks(painter, frame, x_layout, y_layout);
    for (std::size_t s = 0; s < placed.size(); ++s) {
      for (const Point& point : placed[s])
        paint_interval(painter, frame, point, chart.series[s].style.color);
    }
    for (std::size_t s = 0; s < placed.size(); ++s) {
      const Style& style = chart.series[s].style;
      for (const Point& point : placed[s]) {
        // Loose points stand back, and a rim would cut the lines under them.
        const bool joined = style.line != Line::none;
        painter.marker(frame.left + point.x, frame.bottom + point.y, joined ? kMarkerSize : kLooseMarkerSize,
                       style.marker, style.color, joined);
      }
    }
  };
  return draw_svg(scene);
}

void write_chart(const Chart& chart, const std::filesystem::path& path) {
  check_chart_path(path);
  write_svg_as(to_svg(chart), path);
}

}  // namespace pellucid::plots
