#include "sandbox/viewer/panel/controls.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "sandbox/viewer/panel/desk.hpp"
#include "sandbox/viewer/panel/list_popup.hpp"

namespace pellucid::sandbox {

using nanogui::Vector2i;

namespace {

bool pressed(int action) {
  return action == GLFW_PRESS || action == GLFW_REPEAT;
}

bool pushes(int key) {
  return key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER || key == GLFW_KEY_SPACE;
}

}  // namespace

// ---- Field ----

Field::Field(nanogui::Widget* parent) : nanogui::TextBox(parent, "") {
  setEditable(true);
  setAlignment(Alignment::Left);
  setFontSize(paint::kText);
  setCallback([this](const std::string& words) {
    reason_ = offer ? offer(words) : std::string{};
    shown_ = reason_.empty() ? words : shown_;
    just_refused_ = !reason_.empty();
    return true;  // a refused text stays, to be mended
  });
}

void Field::show(const std::string& words) {
  if (editing()) return;
  // Whoever types at once may be ahead of the panel: the value that is shown next was there before.
  if (std::exchange(just_refused_, false)) shown_ = words;
  if (!reason_.empty() && words == shown_) return;  // the refused text stays until something else happens
  reason_.clear();
  shown_ = words;
  setValue(words);
}

bool Field::type(unsigned codepoint) {
  requestFocus();
  // The old text is selected, so that typing replaces it.
  mSelectionPos = 0;
  mCursorPos = static_cast<int>(mValueTemp.size());
  return keyboardCharacterEvent(codepoint);
}

bool Field::keyboardCharacterEvent(unsigned codepoint) {
  const bool taken = nanogui::TextBox::keyboardCharacterEvent(codepoint);
  if (taken && typed) typed(mValueTemp);
  return taken;
}

bool Field::keyboardEvent(int key, int scancode, int action, int modifiers) {
  if (!pressed(action)) return false;
  if (key == GLFW_KEY_ESCAPE) {
    reason_.clear();
    mValueTemp = mValue = shown_;
    mCommitted = true;
    nanogui::TextBox::focusEvent(false);
    if (typed) {
      setValue("");
      typed("");
    }
    return true;
  }
  if (step && (key == GLFW_KEY_UP || key == GLFW_KEY_DOWN)) {
    nanogui::TextBox::focusEvent(false);
    step((key == GLFW_KEY_UP ? 1 : -1) * ((modifiers & GLFW_MOD_SHIFT) != 0 ? 10 : 1));
    return true;
  }
  if (!editing()) {
    if (!pushes(key)) return false;
    requestFocus();
    mSelectionPos = 0;
    mCursorPos = static_cast<int>(mValueTemp.size());
    return true;
  }
  if (key == GLFW_KEY_KP_ENTER) key = GLFW_KEY_ENTER;
  const bool taken = nanogui::TextBox::keyboardEvent(key, scancode, action, modifiers);
  if (typed) typed(mValueTemp);
  return taken;
}

bool Field::focusEvent(bool focused) {
  const bool taken = nanogui::TextBox::focusEvent(focused);
  if (focused) {
    mSelectionPos = 0;
    mCursorPos = static_cast<int>(mValueTemp.size());
  }
  return taken;
}

void Field::draw(NVGcontext* ctx) {
  nanogui::TextBox::draw(ctx);
  if (!reason_.empty()) {
    paint::outline(ctx, static_cast<float>(mPos.x()), static_cast<float>(mPos.y()), static_cast<float>(mSize.x()),
                   static_cast<float>(mSize.y()), paint::warning());
  }
}

// ---- SliderBar ----

void SliderBar::drag_to(int at) {
  constexpr int kMargin = 5;
  const double share = static_cast<double>(at - mPos.x() - kMargin) / std::max(1, mSize.x() - 2 * kMargin);
  if (dragged) dragged(std::clamp(share, 0.0, 1.0));
}

bool SliderBar::mouseButtonEvent(const Vector2i& p, int button, bool down, int) {
  if (button != GLFW_MOUSE_BUTTON_1) return false;
  if (down) {
    requestFocus();
    drag_to(p.x());
  }
  return true;
}

bool SliderBar::mouseDragEvent(const Vector2i& p, const Vector2i&, int, int) {
  drag_to(p.x());
  return true;
}

bool SliderBar::keyboardEvent(int key, int, int action, int modifiers) {
  if (!pressed(action) || !nudge) return false;
  const double by = (modifiers & GLFW_MOD_SHIFT) != 0 ? 10 : 1;
  if (key == GLFW_KEY_LEFT || key == GLFW_KEY_DOWN) {
    nudge(-by);
  } else if (key == GLFW_KEY_RIGHT || key == GLFW_KEY_UP) {
    nudge(by);
  } else if (key == GLFW_KEY_PAGE_DOWN) {
    nudge(-10);
  } else if (key == GLFW_KEY_PAGE_UP) {
    nudge(10);
  } else if (key == GLFW_KEY_HOME) {
    dragged(0);
  } else if (key == GLFW_KEY_END) {
    dragged(1);
  } else {
    return false;
  }
  return true;
}

void SliderBar::draw(NVGcontext* ctx) {
  const float middle = y() + h() / 2, at = x() + 5 + static_cast<float>(share_) * (w() - 10);
  paint::box(ctx, x() + 2, middle - 2, w() - 4, 4, paint::field(), 2);
  paint::box(ctx, x() + 2, middle - 2, std::max(0.0F, at - x() - 2), 4, nvgRGB(110, 130, 160), 2);
  paint::box(ctx, at - 4, middle - 7, 8, 14, mFocused ? paint::accent() : nvgRGB(190, 195, 205), 3);
}

// ---- CheckBox ----

bool CheckBox::mouseButtonEvent(const Vector2i&, int button, bool down, int) {
  if (button != GLFW_MOUSE_BUTTON_1) return false;
  if (down) {
    requestFocus();
    if (changed) changed(!checked_);
  }
  return true;
}

bool CheckBox::keyboardEvent(int key, int, int action, int) {
  if (action != GLFW_PRESS || !pushes(key)) return false;
  if (changed) changed(!checked_);
  return true;
}

void CheckBox::draw(NVGcontext* ctx) {
  const float side = 16, top = y() + (h() - side) / 2;
  paint::box(ctx, x(), top, side, side, paint::field());
  if (!checked_) return;
  nvgBeginPath(ctx);
  nvgMoveTo(ctx, x() + 3.5F, top + 8);
  nvgLineTo(ctx, x() + 7, top + 12);
  nvgLineTo(ctx, x() + 13, top + 4);
  nvgStrokeWidth(ctx, 2);
  nvgStrokeColor(ctx, paint::accent());
  nvgStroke(ctx);
}

// ---- Choice ----

void Choice::open() {
  auto* desk = dynamic_cast<Desk*>(screen());
  if (desk != nullptr && !items.empty()) {
    desk->open_list(this, items, current, [this](const std::string& item) {
      if (chosen) chosen(item);
    });
  }
}

void Choice::move(int by) {
  const auto it = std::find(items.begin(), items.end(), current);
  const auto at = static_cast<int>(it - items.begin()) + by;
  if (it == items.end() || at < 0 || at >= static_cast<int>(items.size())) return;
  if (chosen) chosen(items[static_cast<std::size_t>(at)]);
}

bool Choice::mouseButtonEvent(const Vector2i&, int button, bool down, int) {
  if (button != GLFW_MOUSE_BUTTON_1) return false;
  if (down) {
    requestFocus();
    open();
  }
  return true;
}

bool Choice::keyboardEvent(int key, int, int action, int) {
  if (!pressed(action)) return false;
  if (key == GLFW_KEY_LEFT || key == GLFW_KEY_UP) {
    move(-1);
  } else if (key == GLFW_KEY_RIGHT || key == GLFW_KEY_DOWN) {
    move(1);
  } else if (pushes(key)) {
    open();
  } else {
    return false;
  }
  return true;
}

void Choice::draw(NVGcontext* ctx) {
  paint::box(ctx, x(), y() + 1, w(), h() - 2, paint::field());
  paint::line(ctx, x() + 6, y(), w() - 24, h(), current, paint::text());
  paint::chevron(ctx, x() + w() - 15, y() + h() / 2 - 4, 8, true, paint::dim_text());
}

// ---- PushButton ----

bool PushButton::mouseButtonEvent(const Vector2i& p, int button, bool down, int) {
  if (button != GLFW_MOUSE_BUTTON_1) return false;
  if (down) {
    requestFocus();
    down_ = true;
  } else {
    const bool was_down = std::exchange(down_, false);
    if (was_down && contains(p) && pushed_) pushed_();
  }
  return true;
}

bool PushButton::keyboardEvent(int key, int, int action, int) {
  if (action != GLFW_PRESS || !pushes(key)) return false;
  if (pushed_) pushed_();
  return true;
}

void PushButton::draw(NVGcontext* ctx) {
  paint::box(ctx, x(), y() + 1, w(), h() - 2,
             down_         ? nvgRGB(36, 37, 41)
             : lit         ? nvgRGB(92, 78, 46)
             : mMouseFocus ? nvgRGB(82, 85, 92)
                           : nvgRGB(68, 71, 77));
  paint::line(ctx, x() + 4, y(), w() - 8, h(), words_, paint::text(), paint::kText, paint::Align::center);
}

// ---- Note ----

Vector2i Note::preferredSize(NVGcontext* ctx) const {
  if (words.empty()) return {0, 0};
  const int width = mFixedSize.x() > 0 ? mFixedSize.x() : 300;
  const float height =
      paint::paragraph(ctx, 0, 0, static_cast<float>(width), words, paint::dim_text(), paint::kSmallText, false);
  return {width, static_cast<int>(height) + 4};
}

void Note::draw(NVGcontext* ctx) {
  paint::paragraph(ctx, static_cast<float>(mPos.x()), static_cast<float>(mPos.y()) + 1, static_cast<float>(mSize.x()),
                   words, bad ? paint::warning() : paint::dim_text(), paint::kSmallText, true);
}

}  // namespace pellucid::sandbox
