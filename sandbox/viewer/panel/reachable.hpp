#pragma once

#include <string>
#include <utility>

#include <epoxy/gl.h>
#include <nanogui/opengl.h>
#include <nanogui/screen.h>
#include <nanogui/theme.h>
#include <nanogui/widget.h>

namespace pellucid::sandbox {

/// Mixed into widgets that the keyboard reaches with Tab, and whose hint is shown beside the pointer and for the focus.
class Reachable {
 public:
  virtual ~Reachable() = default;
  virtual bool reachable() const { return true; }
  virtual std::string hint() const { return hint_; }
  void set_hint(std::string text) { hint_ = std::move(text); }
  /// Text typed while the focus is here but nothing is being edited; true when it was taken.
  virtual bool type(unsigned /*codepoint*/) { return false; }

 private:
  std::string hint_;
};

/// A widget of our own: draws itself, hears keys.
class Control : public nanogui::Widget, public Reachable {
 public:
  using nanogui::Widget::Widget;
  bool mouseEnterEvent(const nanogui::Vector2i& p, bool enter) override {
    return nanogui::Widget::mouseEnterEvent(p, enter);
  }

 protected:
  // Where it lies within its parent, as drawing wants it.
  float x() const { return static_cast<float>(mPos.x()); }
  float y() const { return static_cast<float>(mPos.y()); }
  float w() const { return static_cast<float>(mSize.x()); }
  float h() const { return static_cast<float>(mSize.y()); }
};

namespace paint {

inline constexpr int kText = 14;       ///< size of text
inline constexpr int kSmallText = 12;  ///< of second thoughts
inline constexpr int kLine = 24;       ///< height of a row

NVGcolor text();
NVGcolor dim_text();
NVGcolor accent();
NVGcolor warning();
NVGcolor field();
NVGcolor panel();

void box(NVGcontext*, float x, float y, float w, float h, const NVGcolor& fill, float radius = 3);
void outline(NVGcontext*, float x, float y, float w, float h, const NVGcolor&, float width = 1.5F);
enum class Align { left, center, right };
/// One line, vertically centred in `h`; cut with an ellipsis when it is wider than `w`.
void line(NVGcontext*, float x, float y, float w, float h, const std::string&, const NVGcolor&, float size = kText,
          Align = Align::left, bool bold = false);
/// Wrapped text; returns its height. With `draw` false it is only measured.
float paragraph(NVGcontext*, float x, float y, float w, const std::string&, const NVGcolor&, float size, bool draw);
/// A triangle that points right, or down when `open`.
void chevron(NVGcontext*, float x, float y, float size, bool open, const NVGcolor&);

}  // namespace paint

}  // namespace pellucid::sandbox
