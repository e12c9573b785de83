#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sandbox/viewer/panel/reachable.hpp"

namespace pellucid::sandbox {

/// The open list of a Choice. Typing narrows it, arrows move, Enter takes, Escape closes.
class ListPopup : public Control {
 public:
  ListPopup(nanogui::Widget* parent, std::vector<std::string> items, const std::string& current,
            std::function<void(const std::string&)> chosen);
  bool reachable() const override { return false; }
  /// Below `anchor` (x, y, width, height on the screen) or above it, wholly inside a screen of `size`.
  void place(const nanogui::Vector2i& position, const nanogui::Vector2i& anchor_size, const nanogui::Vector2i& size);
  bool closed() const { return closed_; }
  void close() { closed_ = true; }
  bool keyboardEvent(int key, int scancode, int action, int modifiers) override;
  bool keyboardCharacterEvent(unsigned codepoint) override;
  bool mouseButtonEvent(const nanogui::Vector2i&, int button, bool down, int modifiers) override;
  bool mouseMotionEvent(const nanogui::Vector2i&, const nanogui::Vector2i&, int button, int modifiers) override;
  bool scrollEvent(const nanogui::Vector2i&, const nanogui::Vector2f&) override;
  void draw(NVGcontext*) override;

 private:
  void narrow();
  void take();
  int rows() const;
  int row_at(int y) const;
  std::vector<std::string> items_, shown_;
  std::string filter_;
  std::function<void(const std::string&)> chosen_;
  int at_ = 0, first_ = 0;
  bool closed_ = false;
};

}  // namespace pellucid::sandbox
