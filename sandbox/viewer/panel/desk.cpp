#include "sandbox/viewer/panel/desk.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "sandbox/viewer/panel/controls.hpp"

namespace pellucid::sandbox {

using nanogui::Vector2i;

namespace {

constexpr int kPanelWidth = 348;
constexpr int kStatusHeight = 22;
constexpr double kHintDelay_s = 0.6;
constexpr float kKeysLine = 19, kKeysMargin = 14;

void collect(nanogui::Widget* widget, std::vector<nanogui::Widget*>& out) {
  for (nanogui::Widget* child : widget->children()) {
    if (!child->visible()) continue;
    const auto* reachable = dynamic_cast<Reachable*>(child);
    if (reachable != nullptr && reachable->reachable() && child->enabled()) out.push_back(child);
    collect(child, out);
  }
}

bool begins_number(int key) {
  return (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) || (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9) ||
         key == GLFW_KEY_MINUS || key == GLFW_KEY_PERIOD;
}

bool takes_numbers(const nanogui::Widget* widget) {
  const auto* slider = dynamic_cast<const SliderBar*>(widget);
  return (slider != nullptr && slider->digit) || dynamic_cast<const Field*>(widget) != nullptr;
}

}  // namespace

Desk::Desk(GLFWwindow* window, float ui_scale) {
  initialize(window, false);
  mPixelRatio = ui_scale;
  theme()->mStandardFontSize = paint::kText;
  theme()->mTextBoxFontSize = paint::kText;
  theme()->mButtonFontSize = paint::kText;
  panel_ = new ScrollArea(this);
  setVisible(true);
}

void Desk::set_ui_scale(float scale) {
  mPixelRatio = scale;
  resized();
}

int Desk::panel_width() const {
  return panel_->visible() ? std::min(kPanelWidth, mSize.x() * 3 / 4) : 0;
}

void Desk::show_panel(bool shown) {
  if (!shown) updateFocus(nullptr);
  panel_->setVisible(shown);
  layout_changed();
}

void Desk::place() {
  layout_pending_ = false;
  panel_->setPosition({4, 4});
  panel_->setSize({std::max(1, panel_width() - 4), std::max(1, mSize.y() - kStatusHeight - 6)});
  panel_->performLayout(mNVGContext);
  if (focus() != nullptr && focus() != this) panel_->reveal(focus());
}

void Desk::resized() {
  int width = 0, height = 0;
  glfwGetWindowSize(mGLFWWindow, &width, &height);
  mSize = Vector2i(static_cast<int>(static_cast<float>(width) / mPixelRatio),
                   static_cast<int>(static_cast<float>(height) / mPixelRatio));
  if (popup_ != nullptr) popup_->close();
  layout_changed();
}

// ---- focus ----

std::vector<nanogui::Widget*> Desk::ring() {
  std::vector<nanogui::Widget*> all;
  if (panel_->visible()) collect(panel_, all);
  return all;
}

void Desk::focus_next(bool backwards) {
  const std::vector<nanogui::Widget*> all = ring();
  if (all.empty()) return;
  const auto it = std::find(all.begin(), all.end(), focus());
  std::size_t next = backwards ? all.size() - 1 : 0;
  if (it != all.end()) {
    const auto at = static_cast<std::size_t>(it - all.begin());
    next = (at + (backwards ? all.size() - 1 : 1)) % all.size();
  }
  updateFocus(all[next]);
  panel_->reveal(all[next]);
}

bool Desk::editing() const {
  const auto* field = dynamic_cast<const Field*>(focus());
  return field != nullptr && field->editing();
}

void Desk::focus_on(const std::string& id) {
  for (nanogui::Widget* widget : ring())
    if (widget->id() == id) return updateFocus(widget);
}

void Desk::let_go() {
  updateFocus(nullptr);
  mDragWidget = nullptr;
  mDragActive = false;
}

// ---- events ----

bool Desk::mouse_moved(double x, double y) {
  moved_s_ = glfwGetTime();
  return cursorPosCallbackEvent(x, y) || mDragActive;
}

bool Desk::mouse_button(int button, int action, int modifiers) {
  tidy();  // a list that is closed takes no more clicks, drawn or not
  if (keys_shown_ && action == GLFW_PRESS) {
    keys_shown_ = false;
    return true;
  }
  if (popup_ != nullptr && action == GLFW_PRESS && !popup_->contains(mMousePos)) {
    popup_->close();
    return true;
  }
  const bool over = findWidget(mMousePos) != this;
  mouseButtonCallbackEvent(button, action, modifiers);
  return over;
}

bool Desk::scrolled(double x, double y) {
  scrollCallbackEvent(x, y);
  return findWidget(mMousePos) != this;
}

void Desk::key_pressed(int pressed, int scancode, int action, int modifiers) {
  swallow_character_ = false;
  tidy();
  keyCallbackEvent(pressed, scancode, action, modifiers);
}

void Desk::character(unsigned codepoint) {
  if (swallow_character_) return;  // its key has been a command
  if (popup_ != nullptr) {
    popup_->keyboardCharacterEvent(codepoint);
    return;
  }
  if (editing()) {
    charCallbackEvent(codepoint);
    return;
  }
  auto* reachable = dynamic_cast<Reachable*>(focus());
  if (reachable != nullptr && reachable->type(codepoint)) return;
  if (symbol) symbol(codepoint);
}

bool Desk::keyboardEvent(int pressed, int scancode, int action, int modifiers) {
  if (popup_ != nullptr) return popup_->keyboardEvent(pressed, scancode, action, modifiers);
  const bool down = action == GLFW_PRESS || action == GLFW_REPEAT;
  // Shift alone leaves the page, so that the key that opened it closes it too.
  const bool modifier_alone = pressed >= GLFW_KEY_LEFT_SHIFT && pressed <= GLFW_KEY_RIGHT_SUPER;
  if (keys_shown_ && down && (pressed == GLFW_KEY_PAGE_DOWN || pressed == GLFW_KEY_PAGE_UP)) {
    keys_page_ = std::clamp(keys_page_ + (pressed == GLFW_KEY_PAGE_DOWN ? 1 : -1), 0, key_page().pages - 1);
    return true;
  }
  if (keys_shown_ && action == GLFW_PRESS && !modifier_alone) {
    keys_shown_ = false;
    swallow_character_ = true;
    return true;
  }
  if (down && pressed == GLFW_KEY_TAB) {
    focus_next((modifiers & GLFW_MOD_SHIFT) != 0);
    return true;
  }
  if (nanogui::Widget* widget = focus(); widget != nullptr && widget != this) {
    if (widget->keyboardEvent(pressed, scancode, action, modifiers)) return true;
    if (down && pressed == GLFW_KEY_ESCAPE) {
      // The work that runs is cancelled first, as the status line says.
      if (key && key(pressed, action, modifiers)) return true;
      updateFocus(nullptr);
      return true;
    }
  }
  if (modifiers == 0 && begins_number(pressed) && takes_numbers(focus())) return false;  // its character comes next
  if (key && !editing() && key(pressed, action, modifiers)) {
    swallow_character_ = true;
    return true;
  }
  return false;
}

void Desk::open_list(nanogui::Widget* anchor, const std::vector<std::string>& items, const std::string& current,
                     std::function<void(const std::string&)> chosen) {
  if (popup_ != nullptr) return;
  popup_ = new ListPopup(this, items, current, std::move(chosen));
  popup_->setId("list");
  popup_->place(anchor->absolutePosition(), anchor->size(), mSize);
}

void Desk::tidy() {
  if (popup_ == nullptr || !popup_->closed()) return;
  mDragWidget = nullptr;
  mDragActive = false;
  removeChild(popup_);
  popup_ = nullptr;
}

// ---- drawing ----

double Desk::hint_due_s() const {
  return moved_s_ + kHintDelay_s - glfwGetTime();
}

std::string Desk::hint_at_pointer() {
  if (popup_ != nullptr || mDragActive) return "";
  for (nanogui::Widget* widget = findWidget(mMousePos); widget != nullptr && widget != this;
       widget = widget->parent()) {
    if (const auto* reachable = dynamic_cast<Reachable*>(widget); reachable != nullptr && !reachable->hint().empty())
      return reachable->hint();
  }
  return "";
}

void Desk::draw_all() {
  tidy();
  if (layout_pending_) place();
  drawWidgets();
}

void Desk::draw(NVGcontext* ctx) {
  const auto width = static_cast<float>(mSize.x()), height = static_cast<float>(mSize.y());
  const auto left = static_cast<float>(panel_width());
  if (panel_->visible()) paint::box(ctx, 0, 0, left, height - kStatusHeight, paint::panel(), 0);
  if (paint_over) {
    nvgSave(ctx);
    nvgIntersectScissor(ctx, left, 0, width - left, height - kStatusHeight);
    paint_over(ctx, left, 0, width - left, height - kStatusHeight);
    nvgRestore(ctx);
  }
  paint::box(ctx, 0, height - kStatusHeight, width, kStatusHeight, nvgRGB(36, 38, 41), 0);
  if (status) {
    const bool bad = status_is_bad && status_is_bad();
    paint::line(ctx, 8, height - kStatusHeight, width - 16, kStatusHeight, status(),
                bad ? paint::warning() : paint::text(), paint::kText);
  }
  nanogui::Screen::draw(ctx);
  const nanogui::Widget* widget = focus();
  if (widget != nullptr && widget != this && widget->visibleRecursive() && popup_ == nullptr) {
    const Vector2i at = widget->absolutePosition();
    nvgSave(ctx);
    nvgIntersectScissor(ctx, 0, 0, left, height - kStatusHeight);
    paint::outline(ctx, static_cast<float>(at.x()) - 2, static_cast<float>(at.y()) - 1,
                   static_cast<float>(widget->width()) + 4, static_cast<float>(widget->height()) + 2, paint::accent());
    nvgRestore(ctx);
  }
  if (hint_due_s() <= 0) draw_hint(ctx);
  if (keys_shown_) draw_keys(ctx);
}

void Desk::draw_hint(NVGcontext* ctx) {
  const std::string words = hint_at_pointer();
  if (words.empty()) return;
  const float margin = 8;
  const float width = std::min(320.0F, static_cast<float>(mSize.x()) - 4 * margin);
  const float height = paint::paragraph(ctx, 0, 0, width, words, paint::text(), paint::kText, false);
  float x = static_cast<float>(mMousePos.x()) + 16, y = static_cast<float>(mMousePos.y()) + 18;
  x = std::max(0.0F, std::min(x, static_cast<float>(mSize.x()) - width - 2 * margin));
  if (y + height + 2 * margin > static_cast<float>(mSize.y()))
    y = std::max(0.0F, static_cast<float>(mMousePos.y()) - height - 2 * margin - 6);
  paint::box(ctx, x, y, width + 2 * margin, height + 2 * margin, nvgRGBA(18, 19, 21, 245));
  paint::outline(ctx, x, y, width + 2 * margin, height + 2 * margin, nvgRGB(95, 98, 105), 1);
  paint::paragraph(ctx, x + margin, y + margin, width, words, paint::text(), paint::kText, true);
}

void Desk::toggle_keys() {
  keys_shown_ = !keys_shown_;
  keys_page_ = 0;
}

Desk::KeyPage Desk::key_page() const {
  const float room_x = static_cast<float>(mSize.x()) - 2 * kKeysMargin, narrow = 380;
  const float room_y = static_cast<float>(mSize.y()) - 8 - 2 * kKeysMargin;
  const int all = static_cast<int>(keys.size());
  KeyPage out;
  out.columns = std::clamp(static_cast<int>(room_x / narrow), 1, 2);
  const int rows = std::max(1, static_cast<int>(room_y / kKeysLine));
  out.per_column = std::min(rows, (all + out.columns - 1) / out.columns);
  // The last line of a page among several says so.
  if (out.columns * out.per_column < all) {
    out.per_column = std::max(1, rows - 1);
    out.pages = (all + out.columns * out.per_column - 1) / (out.columns * out.per_column);
  }
  return out;
}

void Desk::draw_keys(NVGcontext* ctx) const {
  const float screen_w = static_cast<float>(mSize.x()), screen_h = static_cast<float>(mSize.y());
  const float wide = 500;
  const auto [columns, per_column, pages] = key_page();
  const int lines = per_column + (pages > 1 ? 1 : 0);
  const float column = std::min(wide, (screen_w - 8 - 2 * kKeysMargin) / static_cast<float>(columns));
  const float width = std::min(screen_w - 8, static_cast<float>(columns) * column + 2 * kKeysMargin);
  const float height = std::min(screen_h - 8, static_cast<float>(lines) * kKeysLine + 2 * kKeysMargin);
  const float x = (screen_w - width) / 2, y = (screen_h - height) / 2;
  paint::box(ctx, x, y, width, height, nvgRGBA(18, 19, 21, 240), 6);
  const int page = std::min(keys_page_, pages - 1), first = page * columns * per_column;
  const float name_width = std::min(118.0F, column * 0.4F);
  for (int i = 0; i < columns * per_column && first + i < static_cast<int>(keys.size()); ++i) {
    const float at_x = x + kKeysMargin + static_cast<float>(i / per_column) * column;
    const float at_y = y + kKeysMargin + static_cast<float>(i % per_column) * kKeysLine;
    const auto& [name, meaning] = keys[static_cast<std::size_t>(first + i)];
    paint::line(ctx, at_x, at_y, name_width, kKeysLine, name, paint::accent());
    paint::line(ctx, at_x + name_width + 4, at_y, column - name_width - 8, kKeysLine, meaning, paint::text());
  }
  if (pages == 1) return;
  const std::string words = fmt::format("{} of {}: Page Down and Page Up turn the page", page + 1, pages);
  paint::line(ctx, x + kKeysMargin, y + height - kKeysMargin - kKeysLine, width - 2 * kKeysMargin, kKeysLine, words,
              paint::dim_text());
}

}  // namespace pellucid::sandbox
