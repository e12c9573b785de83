#pragma once

#include <functional>
#include <string>
#include <vector>

#include "plots/charts/chart.hpp"

class vtkChartXY;
class vtkContext2D;
class vtkXMLDataElement;

/// VTK's 2D scene, drawn into an SVG document without any OpenGL. Lengths are pixels from the lower left corner.
namespace pellucid::plots {

enum class Align { low, centre, high };

struct TextStyle {
  double size_px = 12;
  Color color{};
  bool bold = false;
  Align horizontal = Align::low;
  Align vertical = Align::low;  ///< centre: half the height of capitals; high: text hangs below the point
  bool upright = false;         ///< turned by 90° to read from below
};

/// Width of one line of text as it will be drawn [px].
double text_width(const std::string& text, const TextStyle&);
/// Words of `text` in lines of at most `width` pixels.
std::vector<std::string> wrap_text(const std::string& text, const TextStyle&, double width);

/// Draws with VTK's painter on behalf of the functions below.
class Painter {
 public:
  explicit Painter(vtkContext2D* context) : context_(context) {}
  void text(double x, double y, const std::string&, const TextStyle&);
  void line(double x0, double y0, double x1, double y1, const Color&, double width, Line = Line::solid);
  /// Filled, with a thin rim in white that keeps overlapping markers apart, or in the marker's own colour.
  void marker(double x, double y, double size, const Marker&, const Color&, bool white_rim = true);
  void rectangle(double x, double y, double width, double height, const Color& fill);

 private:
  vtkContext2D* context_;
};

struct SvgScene {
  int width_px = 0;
  int height_px = 0;
  std::string title;                    ///< of the document
  std::string description;              ///< for readers who cannot see the drawing
  vtkChartXY* chart = nullptr;          ///< drawn first; may be null
  std::function<void(Painter&)> paint;  ///< drawn over the chart
};

/// The repaired document (see repair_svg).
std::string draw_svg(const SvgScene&);

/// Puts right what VTK 9.1's exporter writes wrong:
///  - `transform` and `clip-path` on one group: the clip rectangle, given in the page's frame, would be transformed too
///    and cut everything away. The group is split in two, the clip outside.
///  - clip rectangles keep VTK's upward y axis: y becomes H − y − h.
///  - shapes without any visible pen or brush are dropped, and the page gets a viewBox and a white ground.
void repair_svg(vtkXMLDataElement* root, int width_px, int height_px);

}  // namespace pellucid::plots
