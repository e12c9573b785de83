#include <string>

#include "sandbox/viewer/panel/reachable.hpp"

namespace pellucid::sandbox::paint {

NVGcolor text() {
  return nvgRGB(225, 225, 225);
}
NVGcolor dim_text() {
  return nvgRGB(160, 160, 165);
}
NVGcolor accent() {
  return nvgRGB(255, 196, 84);
}
NVGcolor warning() {
  return nvgRGB(255, 122, 104);
}
NVGcolor field() {
  return nvgRGB(30, 31, 34);
}
NVGcolor panel() {
  return nvgRGB(47, 49, 53);
}

void box(NVGcontext* ctx, float x, float y, float w, float h, const NVGcolor& fill, float radius) {
  nvgBeginPath(ctx);
  nvgRoundedRect(ctx, x, y, w, h, radius);
  nvgFillColor(ctx, fill);
  nvgFill(ctx);
}

void outline(NVGcontext* ctx, float x, float y, float w, float h, const NVGcolor& color, float width) {
  nvgBeginPath(ctx);
  nvgRoundedRect(ctx, x + width / 2, y + width / 2, w - width, h - width, 3);
  nvgStrokeWidth(ctx, width);
  nvgStrokeColor(ctx, color);
  nvgStroke(ctx);
}

namespace {

std::string fitted(NVGcontext* ctx, const std::string& words, float w) {
  if (nvgTextBounds(ctx, 0, 0, words.c_str(), nullptr, nullptr) <= w) return words;
  std::string cut = words;
  while (!cut.empty()) {
    // Whole code points.
    do {
      cut.pop_back();
    } while (!cut.empty() && (static_cast<unsigned char>(cut.back()) & 0xC0U) == 0x80U);
    if (!cut.empty() && (static_cast<unsigned char>(cut.back()) & 0x80U) != 0) cut.pop_back();
    const std::string with = cut + "…";
    if (nvgTextBounds(ctx, 0, 0, with.c_str(), nullptr, nullptr) <= w) return with;
  }
  return "";
}

}  // namespace

void line(NVGcontext* ctx, float x, float y, float w, float h, const std::string& words, const NVGcolor& color,
          float size, Align align, bool bold) {
  nvgFontFace(ctx, bold ? "sans-bold" : "sans");
  nvgFontSize(ctx, size);
  nvgFillColor(ctx, color);
  const std::string shown = fitted(ctx, words, w);
  const int horizontal = align == Align::left    ? NVG_ALIGN_LEFT
                         : align == Align::right ? NVG_ALIGN_RIGHT
                                                 : NVG_ALIGN_CENTER;
  nvgTextAlign(ctx, horizontal | NVG_ALIGN_MIDDLE);
  const float at = align == Align::left ? x : align == Align::right ? x + w : x + w / 2;
  nvgText(ctx, at, y + h / 2, shown.c_str(), nullptr);
}

float paragraph(NVGcontext* ctx, float x, float y, float w, const std::string& words, const NVGcolor& color, float size,
                bool draw) {
  nvgFontFace(ctx, "sans");
  nvgFontSize(ctx, size);
  nvgTextAlign(ctx, NVG_ALIGN_LEFT | NVG_ALIGN_TOP);
  float bounds[4] = {0, 0, 0, 0};
  nvgTextBoxBounds(ctx, x, y, w, words.c_str(), nullptr, bounds);
  if (draw) {
    nvgFillColor(ctx, color);
    nvgTextBox(ctx, x, y, w, words.c_str(), nullptr);
  }
  return bounds[3] - y;
}

void chevron(NVGcontext* ctx, float x, float y, float size, bool open, const NVGcolor& color) {
  nvgBeginPath(ctx);
  if (open) {
    nvgMoveTo(ctx, x, y + size * 0.25F);
    nvgLineTo(ctx, x + size, y + size * 0.25F);
    nvgLineTo(ctx, x + size / 2, y + size * 0.85F);
  } else {
    nvgMoveTo(ctx, x + size * 0.25F, y);
    nvgLineTo(ctx, x + size * 0.85F, y + size / 2);
    nvgLineTo(ctx, x + size * 0.25F, y + size);
  }
  nvgClosePath(ctx);
  nvgFillColor(ctx, color);
  nvgFill(ctx);
}

}  // namespace pellucid::sandbox::paint
