#include "sandbox/viewer/panel/layout.hpp"

#include <algorithm>

#include "sandbox/viewer/panel/desk.hpp"

namespace pellucid::sandbox {

using nanogui::Vector2f;
using nanogui::Vector2i;

namespace {

constexpr int kScrollBar = 8;
constexpr int kBarLabel = 96;

}  // namespace

// ---- Stack ----

Vector2i Stack::preferredSize(NVGcontext* ctx) const {
  const int width = mFixedSize.x() > 0 ? mFixedSize.x() : mSize.x();
  int height = 0;
  for (nanogui::Widget* child : mChildren) {
    if (!child->visible()) continue;
    child->setFixedWidth(width);
    const int of_child = child->preferredSize(ctx).y();
    if (of_child > 0) height += of_child + gap_;
  }
  return {width, height};
}

void Stack::performLayout(NVGcontext* ctx) {
  int y = 0;
  for (nanogui::Widget* child : mChildren) {
    if (!child->visible()) continue;
    child->setFixedWidth(mSize.x());
    const int height = child->preferredSize(ctx).y();
    child->setPosition({0, y});
    child->setSize({mSize.x(), height});
    child->performLayout(ctx);
    if (height > 0) y += height + gap_;
  }
}

// ---- Bar ----

Vector2i Bar::preferredSize(NVGcontext*) const {
  return {mFixedSize.x(), paint::kLine};
}

void Bar::performLayout(NVGcontext* ctx) {
  const int from = words_.empty() ? 0 : kBarLabel;
  const auto count =
      static_cast<int>(std::count_if(mChildren.begin(), mChildren.end(), [](auto* c) { return c->visible(); }));
  if (count == 0) return;
  constexpr int kGap = 4;
  const int width = (mSize.x() - from - kGap * (count - 1)) / count;
  int x = from;
  for (nanogui::Widget* child : mChildren) {
    if (!child->visible()) continue;
    child->setPosition({x, 0});
    child->setSize({width, mSize.y()});
    child->performLayout(ctx);
    x += width + kGap;
  }
}

void Bar::draw(NVGcontext* ctx) {
  paint::line(ctx, static_cast<float>(mPos.x()), static_cast<float>(mPos.y()), kBarLabel - 4,
              static_cast<float>(mSize.y()), words_, paint::dim_text());
  nanogui::Widget::draw(ctx);
}

// ---- Section ----

class Section::Headline : public Control {
 public:
  Headline(nanogui::Widget* parent, Section& section) : Control(parent), section_(section) {
    setId("headline " + section.title());
    set_hint("Folds or unfolds this section.");
  }
  bool mouseButtonEvent(const Vector2i&, int button, bool down, int) override {
    if (button != GLFW_MOUSE_BUTTON_1) return false;
    if (down) {
      requestFocus();
      section_.set_open(!section_.open());
    }
    return true;
  }
  bool keyboardEvent(int key, int, int action, int) override {
    if (action != GLFW_PRESS) return false;
    if (key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER || key == GLFW_KEY_SPACE) {
      section_.set_open(!section_.open());
    } else if (key == GLFW_KEY_LEFT) {
      section_.set_open(false);
    } else if (key == GLFW_KEY_RIGHT) {
      section_.set_open(true);
    } else {
      return false;
    }
    return true;
  }
  void draw(NVGcontext* ctx) override {
    paint::box(ctx, x(), y(), w(), h(), nvgRGB(58, 61, 67));
    paint::chevron(ctx, x() + 6, y() + h() / 2 - 5, 10, section_.open(), paint::dim_text());
    paint::line(ctx, x() + 22, y(), w() - 26, h(), section_.title(), paint::text(), paint::kText, paint::Align::left,
                true);
  }

 private:
  Section& section_;
};

Section::Section(nanogui::Widget* parent, const std::string& title, bool open)
    : nanogui::Widget(parent), title_(title), headline_(new Headline(this, *this)), body_(new Stack(this)) {
  body_->setVisible(open);
  setId("section " + title);
}

void Section::set_open(bool open) {
  body_->setVisible(open);
  if (auto* desk = dynamic_cast<Desk*>(screen())) desk->layout_changed();
}

Vector2i Section::preferredSize(NVGcontext* ctx) const {
  int height = paint::kLine + 3;
  if (open()) {
    body_->setFixedWidth(mFixedSize.x() - 8);
    height += body_->preferredSize(ctx).y() + 3;
  }
  return {mFixedSize.x(), height};
}

void Section::performLayout(NVGcontext* ctx) {
  headline_->setPosition({0, 0});
  headline_->setSize({mSize.x(), paint::kLine});
  if (!open()) return;
  body_->setPosition({4, paint::kLine + 3});
  body_->setSize({mSize.x() - 8, mSize.y() - paint::kLine - 3});
  body_->performLayout(ctx);
}

// ---- ScrollArea ----

ScrollArea::ScrollArea(nanogui::Widget* parent) : nanogui::Widget(parent), content_(new Stack(this)) {}

void ScrollArea::performLayout(NVGcontext* ctx) {
  content_->setFixedWidth(mSize.x() - kScrollBar - 2);
  content_->setSize({mSize.x() - kScrollBar - 2, content_->preferredSize(ctx).y()});
  content_->performLayout(ctx);
  scroll_to(offset_);
}

void ScrollArea::scroll_to(int offset) {
  offset_ = std::clamp(offset, 0, std::max(0, content_->height() - mSize.y()));
  content_->setPosition({0, -offset_});
}

void ScrollArea::reveal(const nanogui::Widget* widget) {
  const int top = widget->absolutePosition().y() - content_->absolutePosition().y();
  if (top < offset_) scroll_to(top - paint::kLine);
  if (top + widget->height() > offset_ + mSize.y()) scroll_to(top + widget->height() - mSize.y() + paint::kLine);
}

bool ScrollArea::scrollEvent(const Vector2i&, const Vector2f& by) {
  scroll_to(offset_ - static_cast<int>(by.y() * 2.5F * static_cast<float>(paint::kLine)));
  return true;
}

bool ScrollArea::mouseButtonEvent(const Vector2i& p, int button, bool down, int modifiers) {
  return nanogui::Widget::mouseButtonEvent(p, button, down, modifiers) || button == GLFW_MOUSE_BUTTON_1;
}

bool ScrollArea::mouseDragEvent(const Vector2i&, const Vector2i& by, int, int) {
  scroll_to(offset_ + by.y() * content_->height() / std::max(1, mSize.y()));
  return true;
}

void ScrollArea::draw(NVGcontext* ctx) {
  nanogui::Widget::draw(ctx);
  const int height = content_->height();
  if (height <= mSize.y()) return;
  const auto area = static_cast<float>(mSize.y());
  const float share = area / static_cast<float>(height);
  const float x = static_cast<float>(mPos.x() + mSize.x() - kScrollBar);
  paint::box(ctx, x, static_cast<float>(mPos.y()), kScrollBar - 2, area, paint::field());
  paint::box(ctx, x, static_cast<float>(mPos.y()) + static_cast<float>(offset_) * share, kScrollBar - 2, area * share,
             nvgRGB(110, 113, 120));
}

}  // namespace pellucid::sandbox
