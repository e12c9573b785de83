#pragma once

#include <string>

#include "plots/charts/style.hpp"
#include "plots/charts/svg_scene.hpp"

/// Line charts and heat maps share this: type sizes, margins, title, note and axis titles.
namespace pellucid::plots {

inline const TextStyle kTitleText{14, kInk, true, Align::low, Align::high, false};
inline const TextStyle kAxisText{13, kInk, false, Align::centre, Align::low, false};
inline const TextStyle kTickText{12, kInk, false, Align::low, Align::low, false};
inline const TextStyle kNoteText{10, kFaintInk, false, Align::low, Align::low, false};
inline constexpr double kMargin = 8;
inline constexpr double kLegendRow = 18;
inline constexpr double kAxisTitleRow = 20;
inline constexpr double kNoteRow = 13;

/// The rectangle of the plot itself in pixels from the lower left corner, and what stands around it.
struct Frame {
  double left = 0, bottom = 0, right = 0, top = 0;
  double page_width = 0, page_height = 0;
  double legend_top = 0;
  double note_top = 0;  ///< upper edge of the note, which is also the lower edge of the x axis's title
  double width() const { return right - left; }
  double height() const { return top - bottom; }
};

/// The page less margins, title and note.
Frame outer_frame(const std::string& title, const std::string& note, int width_px, int height_px);
/// Throws InputError when title, legend and note leave too little room for the plot.
void check_frame(const Frame&, const std::string& title);
/// Width of an upright axis's title, which takes as many lines as the plot's height asks for.
double upright_width(const Frame&, const std::string& title);
/// From the left edge `x` on.
void paint_upright(Painter&, const Frame&, double x, const std::string& title);
void paint_frame_texts(Painter&, const Frame&, const std::string& title, const std::string& note,
                       const std::string& x_title, const std::string& y_title);

}  // namespace pellucid::plots
