#include "plots/charts/chart_layout.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "gl/error.hpp"

namespace pellucid::plots {
namespace {

constexpr double kTitleRow = 19;

std::vector<std::string> title_lines(const std::string& title, double page_width) {
  return wrap_text(title, kTitleText, page_width - 2 * kMargin);
}

std::vector<std::string> note_lines(const std::string& note, double page_width) {
  return wrap_text(note, kNoteText, page_width - 2 * kMargin);
}

std::vector<std::string> upright_lines(const Frame& frame, const std::string& title) {
  return wrap_text(title, kAxisText, frame.height());
}

}  // namespace

Frame outer_frame(const std::string& title, const std::string& note, int width_px, int height_px) {
  Frame frame;
  frame.page_width = width_px;
  frame.page_height = height_px;
  frame.left = kMargin;
  frame.right = width_px - 2 * kMargin;
  frame.top = height_px - kMargin - static_cast<double>(title_lines(title, width_px).size()) * kTitleRow;
  frame.legend_top = frame.top;
  frame.note_top = kMargin + static_cast<double>(note_lines(note, width_px).size()) * kNoteRow;
  frame.bottom = frame.note_top;
  return frame;
}

void check_frame(const Frame& frame, const std::string& title) {
  constexpr double kLeast = 60;
  if (frame.width() < kLeast || frame.height() < kLeast) {
    throw InputError(fmt::format("chart '{}': {}×{} px leave no room for the plot between title, legend and note",
                                 title, frame.page_width, frame.page_height));
  }
}

double upright_width(const Frame& frame, const std::string& title) {
  return kAxisTitleRow * std::max(1.0, static_cast<double>(upright_lines(frame, title).size()));
}

void paint_upright(Painter& painter, const Frame& frame, double x, const std::string& title) {
  TextStyle upright = kAxisText;
  upright.upright = true;
  upright.vertical = Align::high;
  for (const std::string& line : upright_lines(frame, title)) {
    painter.text(x, (frame.bottom + frame.top) / 2, line, upright);
    x += kAxisTitleRow;
  }
}

void paint_frame_texts(Painter& painter, const Frame& frame, const std::string& title, const std::string& note,
                       const std::string& x_title, const std::string& y_title) {
  double y = frame.page_height - kMargin;
  for (const std::string& line : title_lines(title, frame.page_width)) {
    painter.text(kMargin, y, line, kTitleText);
    y -= kTitleRow;
  }
  painter.text((frame.left + frame.right) / 2, frame.note_top + 8, x_title, kAxisText);
  paint_upright(painter, frame, kMargin, y_title);
  y = frame.note_top - kNoteRow + 3;
  for (const std::string& line : note_lines(note, frame.page_width)) {
    painter.text(kMargin, y, line, kNoteText);
    y -= kNoteRow;
  }
}

}  // namespace pellucid::plots
