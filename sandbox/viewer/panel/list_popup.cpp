#include "sandbox/viewer/panel/list_popup.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace pellucid::sandbox {

using nanogui::Vector2f;
using nanogui::Vector2i;

namespace {
constexpr int kRow = 21;
constexpr int kMargin = 4;
}  // namespace

ListPopup::ListPopup(nanogui::Widget* parent, std::vector<std::string> items, const std::string& current,
                     std::function<void(const std::string&)> chosen)
    : Control(parent), items_(std::move(items)), shown_(items_), chosen_(std::move(chosen)) {
  const auto it = std::find(shown_.begin(), shown_.end(), current);
  at_ = it == shown_.end() ? 0 : static_cast<int>(it - shown_.begin());
}

void ListPopup::place(const Vector2i& position, const Vector2i& anchor_size, const Vector2i& size) {
  const int wanted = static_cast<int>(items_.size()) * kRow + 2 * kMargin;
  const int height = std::min(wanted, std::max(kRow + 2 * kMargin, size.y() - 8));
  const int width = std::min(std::max(anchor_size.x(), 180), size.x() - 8);
  int top = position.y() + anchor_size.y();
  if (top + height > size.y() - 4) top = position.y() - height;
  if (top < 4) top = std::max(4, size.y() - 4 - height);
  setPosition({std::clamp(position.x(), 4, std::max(4, size.x() - 4 - width)), top});
  setSize({width, height});
  first_ = std::clamp(at_ - rows() / 2, 0, std::max(0, static_cast<int>(shown_.size()) - rows()));
}

int ListPopup::rows() const {
  return std::max(1, (mSize.y() - 2 * kMargin) / kRow);
}

int ListPopup::row_at(int at) const {
  const int row = first_ + (at - mPos.y() - kMargin) / kRow;
  return row >= 0 && row < static_cast<int>(shown_.size()) ? row : -1;
}

void ListPopup::narrow() {
  shown_.clear();
  for (const std::string& item : items_)
    if (item.find(filter_) != std::string::npos) shown_.push_back(item);
  at_ = first_ = 0;
}

void ListPopup::take() {
  closed_ = true;
  if (at_ < static_cast<int>(shown_.size())) chosen_(shown_[static_cast<std::size_t>(at_)]);
}

bool ListPopup::keyboardEvent(int key, int, int action, int) {
  if (action != GLFW_PRESS && action != GLFW_REPEAT) return true;
  const auto last = static_cast<int>(shown_.size()) - 1;
  if (key == GLFW_KEY_ESCAPE || key == GLFW_KEY_TAB) {
    closed_ = true;
  } else if (key == GLFW_KEY_ENTER || key == GLFW_KEY_KP_ENTER) {
    take();
  } else if (key == GLFW_KEY_BACKSPACE && !filter_.empty()) {
    filter_.pop_back();
    narrow();
  } else {
    const int by = key == GLFW_KEY_UP          ? -1
                   : key == GLFW_KEY_DOWN      ? 1
                   : key == GLFW_KEY_PAGE_UP   ? -rows()
                   : key == GLFW_KEY_PAGE_DOWN ? rows()
                   : key == GLFW_KEY_HOME      ? -last
                   : key == GLFW_KEY_END       ? last
                                               : 0;
    at_ = std::clamp(at_ + by, 0, std::max(0, last));
    first_ = std::clamp(first_, std::max(0, at_ - rows() + 1), std::max(0, at_));
  }
  return true;
}

bool ListPopup::keyboardCharacterEvent(unsigned codepoint) {
  if (codepoint < 32 || codepoint > 126) return true;
  filter_ += static_cast<char>(codepoint);
  narrow();
  return true;
}

bool ListPopup::mouseButtonEvent(const Vector2i& p, int button, bool down, int) {
  if (button != GLFW_MOUSE_BUTTON_1 || !down) return true;
  if (const int row = row_at(p.y()); row >= 0) {
    at_ = row;
    take();
  }
  return true;
}

bool ListPopup::mouseMotionEvent(const Vector2i& p, const Vector2i&, int, int) {
  if (const int row = row_at(p.y()); row >= 0) at_ = row;
  return true;
}

bool ListPopup::scrollEvent(const Vector2i&, const Vector2f& by) {
  first_ = std::clamp(first_ - static_cast<int>(by.y() * 3), 0, std::max(0, static_cast<int>(shown_.size()) - rows()));
  return true;
}

void ListPopup::draw(NVGcontext* ctx) {
  paint::box(ctx, x(), y(), w(), h(), nvgRGB(24, 25, 28));
  paint::outline(ctx, x(), y(), w(), h(), nvgRGB(95, 98, 105), 1);
  if (shown_.empty())
    paint::line(ctx, x() + 8, y() + kMargin, w() - 16, kRow, "nothing with '" + filter_ + "'", paint::warning());
  for (int row = 0; row < rows() && first_ + row < static_cast<int>(shown_.size()); ++row) {
    const float top = y() + static_cast<float>(kMargin + row * kRow);
    if (first_ + row == at_) paint::box(ctx, x() + 2, top, w() - 4, kRow, nvgRGB(78, 82, 92));
    paint::line(ctx, x() + 8, top, w() - 16, kRow, shown_[static_cast<std::size_t>(first_ + row)], paint::text());
  }
}

}  // namespace pellucid::sandbox
