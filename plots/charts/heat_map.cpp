#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <vtkColorTransferFunction.h>
#include <vtkSmartPointer.h>

#include "gl/error.hpp"
#include "plots/charts/chart.hpp"
#include "plots/charts/chart_layout.hpp"
#include "plots/charts/svg_scene.hpp"
#include "plots/charts/ticks.hpp"

namespace pellucid::plots {
namespace {

constexpr double kBarWidth = 14;
constexpr double kBarGap = 14;
constexpr Color kMissing{238, 238, 238};
constexpr Color kOutline = kPalette[1];
const TextStyle kMarkText{8, kInk, false, Align::centre, Align::centre, false};

/// Where a value stands between the least and the greatest: 0 to 1.
struct ValueScale {
  double low = 0, high = 1;
  Scale scale = Scale::linear;
  double operator()(double value) const {
    if (!(high > low)) return 0.5;
    return scale == Scale::linear ? (value - low) / (high - low)
                                  : (std::log(value) - std::log(low)) / (std::log(high) - std::log(low));
  }
};

/// Light yellow to deep blue through CIELAB: lightness falls all the way, so it reads the same in grey and for any eye.
vtkSmartPointer<vtkColorTransferFunction> color_ramp() {
  auto ramp = vtkSmartPointer<vtkColorTransferFunction>::New();
  ramp->SetColorSpaceToLab();
  ramp->AddRGBPoint(0.0, 1.0, 0.98, 0.82);
  ramp->AddRGBPoint(0.35, 0.55, 0.82, 0.72);
  ramp->AddRGBPoint(0.7, 0.16, 0.5, 0.68);
  ramp->AddRGBPoint(1.0, 0.07, 0.16, 0.38);
  return ramp;
}

Color color_at(vtkColorTransferFunction* ramp, double t) {
  double rgb[3];
  ramp->GetColor(std::clamp(t, 0.0, 1.0), rgb);
  const auto byte = [](double v) { return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0, 1.0) * 255)); };
  return {byte(rgb[0]), byte(rgb[1]), byte(rgb[2])};
}

Color ink_on(const Color& ground) {
  const double luma = 0.2126 * ground.r + 0.7152 * ground.g + 0.0722 * ground.b;
  return luma > 140 ? kInk : Color{255, 255, 255};
}

/// Three significant digits, whole numbers from 100 on.
std::string cell_label(double value) {
  const double size = std::abs(value);
  if (size < kLeastShown) return "0";
  if (size >= 1e5 || size < 1e-3) return fmt::format("{}{}", value < 0 ? "-" : "", power_label(size));
  const int decimals = std::clamp(2 - static_cast<int>(std::floor(std::log10(size))), 0, 5);
  return fmt::format("{:.{}f}", value, decimals);
}

ValueScale check(const HeatMap& map) {
  if (map.columns.empty() || map.rows.empty()) throw InputError(fmt::format("heat map '{}' has no data", map.title));
  ValueScale scale{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), map.value_scale};
  if (map.values.size() != map.rows.size()) {
    throw InputError(fmt::format("heat map '{}' has {} rows of values for {} labels", map.title, map.values.size(),
                                 map.rows.size()));
  }
  for (std::size_t r = 0; r < map.rows.size(); ++r) {
    if (map.values[r].size() != map.columns.size()) {
      throw InputError(fmt::format("heat map '{}': row '{}' has {} values for {} columns", map.title, map.rows[r],
                                   map.values[r].size(), map.columns.size()));
    }
    for (std::size_t c = 0; c < map.columns.size(); ++c) {
      const std::optional<double>& value = map.values[r][c];
      if (!value) continue;
      if (!std::isfinite(*value)) {
        throw InputError(fmt::format("heat map '{}': the value at ({}, {}) is not a finite number", map.title,
                                     map.columns[c], map.rows[r]));
      }
      if (!drawable(*value, map.value_scale))
        throw InputError(
            fmt::format("heat map '{}': the value {} at ({}, {}) is beyond what can be shown, {:g} to {:g}", map.title,
                        *value, map.columns[c], map.rows[r], kLeastShown, kMostShown));
      if (map.value_scale != Scale::linear && *value <= 0) {
        throw InputError(fmt::format("heat map '{}': the value {} at ({}, {}) cannot stand on a logarithmic scale",
                                     map.title, *value, map.columns[c], map.rows[r]));
      }
      scale.low = std::min(scale.low, *value);
      scale.high = std::max(scale.high, *value);
    }
  }
  if (!(scale.low <= scale.high)) throw InputError(fmt::format("heat map '{}' has no data", map.title));
  for ([[maybe_unused]] const HeatMap::Mark& mark : map.marks)
    assert(mark.cell.row < map.rows.size() && mark.cell.column < map.columns.size());
  return scale;
}

/// The words of the marks in a cell.
std::string mark_label(const HeatMap& map, const HeatMap::Cell& cell) {
  std::vector<std::string> words;
  for (const HeatMap::Mark& mark : map.marks) {
    if (mark.cell.row == cell.row && mark.cell.column == cell.column) words.push_back(mark.label);
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

struct Box {
  double left, bottom, right, top;
};

/// The n-th mark's: each lies further in, and all but the first are dashed.
void paint_outline(Painter& painter, const Box& cell, std::size_t n) {
  constexpr double kWidth = 2.5;
  const double inset = 1 + 4 * static_cast<double>(n);
  const Box box{cell.left + inset, cell.bottom + inset, cell.right - inset, cell.top - inset};
  const auto side = [&](double x0, double y0, double x1, double y1) {
    painter.line(x0, y0, x1, y1, kOutline, kWidth, n == 0 ? Line::solid : Line::dashed);
  };
  side(box.left, box.bottom, box.right, box.bottom);
  side(box.right, box.bottom, box.right, box.top);
  side(box.right, box.top, box.left, box.top);
  side(box.left, box.top, box.left, box.bottom);
}

std::string description(const HeatMap& map) {
  std::string text = fmt::format("{} over {} and {}.", map.value_label, map.x_label, map.y_label);
  for (std::size_t r = 0; r < map.rows.size(); ++r) {
    for (std::size_t c = 0; c < map.columns.size(); ++c) {
      if (map.values[r][c]) text += fmt::format(" ({}, {}): {:.5g}.", map.columns[c], map.rows[r], *map.values[r][c]);
    }
  }
  for (const HeatMap::Mark& mark : map.marks)
    text += fmt::format(" Marked as {}: ({}, {}).", mark.label, map.columns[mark.cell.column], map.rows[mark.cell.row]);
  return map.note.empty() ? text : text + " " + map.note;
}

}  // namespace

std::string to_svg(const HeatMap& map) {
  const ValueScale scale = check(map);
  const auto ramp = color_ramp();
  Frame frame = outer_frame(map.title, map.note, map.width_px, map.height_px);
  double widest = 0;
  for (const std::string& row : map.rows)
    widest = std::max(widest, text_width(row, kTickText));
  const AxisLayout bar = lay_out_axis({map.value_label, {}, map.value_scale, false}, scale.low, scale.high, 5);
  double widest_value = 0;
  for (const Tick& tick : bar.ticks)
    widest_value = std::max(widest_value, text_width(tick.label, kTickText));
  frame.bottom += kTickText.size_px + 10 + kAxisTitleRow;
  frame.top -= 4;
  frame.left += upright_width(frame, map.y_label) + widest + 8;
  frame.right -= kBarGap + kBarWidth + 6 + widest_value + upright_width(frame, map.value_label) - kMargin;
  check_frame(frame, map.title);

  const double cell_width = frame.width() / static_cast<double>(map.columns.size());
  const double cell_height = frame.height() / static_cast<double>(map.rows.size());
  double widest_cell = 0;
  for (const auto& row : map.values) {
    for (const auto& value : row)
      widest_cell = std::max(widest_cell, value ? text_width(cell_label(*value), kTickText) : 0);
  }
  TextStyle cell_text = kTickText;
  cell_text.horizontal = cell_text.vertical = Align::centre;
  cell_text.size_px = std::floor(std::min({12.0, 12 * (cell_width - 4) / std::max(widest_cell, 1.0), cell_height - 4}));

  SvgScene scene{map.width_px, map.height_px, map.title, description(map), nullptr, {}};
  scene.paint = [&](Painter& painter) {
    paint_frame_texts(painter, frame, map.title, map.note, map.x_label, map.y_label);
    for (std::size_t r = 0; r < map.rows.size(); ++r) {
      const double y = frame.bottom + static_cast<double>(r) * cell_height;
      TextStyle label = kTickText;
      label.horizontal = Align::high;
      label.vertical = Align::centre;
      painter.text(frame.left - 6, y + cell_height / 2, map.rows[r], label);
      for (std::size_t c = 0; c < map.columns.size(); ++c) {
        const double x = frame.left + static_cast<double>(c) * cell_width;
        const std::optional<double>& value = map.values[r][c];
        const Color ground = value ? color_at(ramp, scale(*value)) : kMissing;
        painter.rectangle(x + 0.5, y + 0.5, cell_width - 1, cell_height - 1, ground);
        // Below 6 px a number is a smear: the colour has to do.
        if (!value || cell_text.size_px < 6) continue;
        cell_text.color = ink_on(ground);
        const std::string mark_words = mark_label(map, {r, c});
        const double rise = mark_words.empty() ? 0 : kMarkText.size_px / 2;
        painter.text(x + cell_width / 2, y + cell_height / 2 + rise, cell_label(*value), cell_text);
        TextStyle mark = kMarkText;
        mark.color = cell_text.color;
        if (!mark_words.empty()) {
          painter.text(x + cell_width / 2, y + cell_height / 2 - cell_text.size_px / 2, mark_words, mark);
        }
      }
    }
    for (std::size_t c = 0; c < map.columns.size(); ++c) {
      TextStyle label = kTickText;
      label.horizontal = Align::centre;
      label.vertical = Align::high;
      painter.text(frame.left + (static_cast<double>(c) + 0.5) * cell_width, frame.bottom - 5, map.columns[c], label);
    }
    for (std::size_t i = 0; i < map.marks.size(); ++i) {
      const HeatMap::Cell& cell = map.marks[i].cell;
      const double x = frame.left + static_cast<double>(cell.column) * cell_width;
      const double y = frame.bottom + static_cast<double>(cell.row) * cell_height;
      paint_outline(painter, {x, y, x + cell_width, y + cell_height}, i);
    }
    // The bar that says which colour is which value spans the data, not the ticks' round range.
    const double bar_left = frame.right + kBarGap;
    constexpr int kBarSteps = 64;
    const double step = frame.height() / kBarSteps;
    for (int i = 0; i < kBarSteps; ++i) {
      painter.rectangle(bar_left, frame.bottom + i * step, kBarWidth, step + (i + 1 < kBarSteps ? 0.5 : 0),
                        color_at(ramp, (i + 0.5) / kBarSteps));
    }
    for (const Tick& tick : bar.ticks) {
      const double t = scale(tick.value);
      if (t < -1e-9 || t > 1 + 1e-9) continue;
      const double y = frame.bottom + t * frame.height();
      painter.line(bar_left + kBarWidth, y, bar_left + kBarWidth + 3, y, kInk, 1);
      TextStyle label = kTickText;
      label.vertical = Align::centre;
      painter.text(bar_left + kBarWidth + 6, y, tick.label, label);
    }
    paint_upright(painter, frame, frame.page_width - kMargin - upright_width(frame, map.value_label), map.value_label);
  };
  return draw_svg(scene);
}

void write_chart(const HeatMap& map, const std::filesystem::path& path) {
  check_chart_path(path);
  write_svg_as(to_svg(map), path);
}

}  // namespace pellucid::plots
