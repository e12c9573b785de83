#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Charts for print: a plain description in, one SVG, PNG or PDF file out. Drawn with VTK on the CPU; no GL context and
/// no display is needed.
namespace pellucid::plots {

enum class Scale { linear, log2, log10 };

struct Axis {
  std::string label;
  std::string unit{};  ///< shown in brackets behind the label; empty for pure numbers
  Scale scale = Scale::linear;
  bool from_zero = false;  ///< linear axes only: the range starts at 0
  std::string field{};     ///< what its numbers are called in the chart's data
};

struct Color {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Color&) const = default;
};

enum class Marker { none, circle, square, diamond, triangle_up, triangle_down, cross, plus };
enum class Line { none, solid, dashed, dotted };

struct Style {
  Color color{};
  Marker marker = Marker::circle;
  Line line = Line::solid;
};

/// A value with an optional interval. On a logarithmic axis an end of the interval that is not positive reaches the
/// lower edge of the plot; a value that is not positive is an error.
struct Point {
  double x = 0;
  double y = 0;
  std::optional<double> low{};
  std::optional<double> high{};
};

struct Series {
  std::string label;          ///< for the legend; empty for none
  std::vector<Point> points;  ///< joined in this order
  Style style{};
  double shift_px = 0;  ///< to the right: keeps the intervals of several series at one x apart
  std::string name{};   ///< what it shows, also where the legend leaves it out
};

struct Chart {
  std::string title;
  std::string note{};  ///< small print below the plot: device, clock, what the bars are; wrapped to the width
  Axis x, y;
  std::vector<Series> series;
  int width_px = 460;   ///< CSS pixels; the default sets 8 pt type in a 3.4 inch column
  int height_px = 340;  ///< with one row of legend; each further row adds its own height
};

/// A number on each cell of a plane of categories, coloured by its value.
struct HeatMap {
  std::string title;
  std::string note{};
  std::string x_label, y_label, value_label;
  std::vector<std::string> columns;                        ///< from the left
  std::vector<std::string> rows;                           ///< from the bottom
  std::vector<std::vector<std::optional<double>>> values;  ///< [row][column]; nothing where there was no measurement
  Scale value_scale = Scale::linear;                       ///< of the colours
  struct Cell {
    std::size_t row = 0, column = 0;
  };
  /// A cell to point out, outlined and labelled. The first's outline is solid, the others' are dashed, so that two in
  /// one cell can be told apart.
  struct Mark {
    Cell cell{};
    std::string label{};  ///< a word or two, below the number
  };
  std::vector<Mark> marks{};
  int width_px = 460;
  int height_px = 340;
};

/// The drawing as one SVG document. Throws InputError when there is nothing to draw, when a number is not finite, or
/// when a logarithmic axis is asked to show a value that is not positive; the message names series and point.
std::string to_svg(const Chart&);
std::string to_svg(const HeatMap&);

/// Writes SVG, PNG or PDF by the extension of `path`; the file appears whole or not at all. PNG and PDF need the
/// program rsvg-convert. Throws InputError (extension, data) or RuntimeError (folder, missing program).
void write_chart(const Chart&, const std::filesystem::path&);
void write_chart(const HeatMap&, const std::filesystem::path&);
/// The same for a finished SVG document.
void write_svg_as(const std::string& svg, const std::filesystem::path&);

/// Throws InputError unless the extension is one that write_chart() knows: to be called before long work.
void check_chart_path(const std::filesystem::path&);

}  // namespace pellucid::plots
