#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "sandbox/viewer/panel/layout.hpp"
#include "sandbox/viewer/panel/list_popup.hpp"

namespace pellucid::sandbox {

/// The whole of what lies over the picture: the docked panel, an open list, hints, the page of keys. It adds to nanogui
/// what that lacks: a focus that Tab moves, pop-ups that stay inside, a scale in fractions.
class Desk : public nanogui::Screen {
 public:
  /// Takes over drawing in `window`, not its callbacks.
  Desk(GLFWwindow* window, float ui_scale);

  ScrollArea* panel() const { return panel_; }
  int panel_width() const;  ///< in the desk's own units; 0 while hidden
  void show_panel(bool shown);
  float ui_scale() const { return mPixelRatio; }
  void set_ui_scale(float);
  nanogui::Vector2i size_in_units() const { return mSize; }

  std::function<std::string()> status;                                              ///< the line at the bottom
  std::function<bool()> status_is_bad;                                              ///< it tells of a failure
  std::function<bool(int key, int action, int modifiers)> key;                      ///< what no widget took
  std::function<bool(unsigned codepoint)> symbol;                                   ///< the same for what is typed
  std::function<void(NVGcontext*, float x, float y, float w, float h)> paint_over;  ///< over the picture's area
  std::vector<std::pair<std::string, std::string>> keys;                            ///< the page of keys

  // The window's callbacks hand these on; true when it was the desk's.
  bool mouse_moved(double x, double y);
  bool mouse_button(int button, int action, int modifiers);
  bool scrolled(double x, double y);
  void key_pressed(int key, int scancode, int action, int modifiers);
  void character(unsigned codepoint);
  void resized();

  void open_list(nanogui::Widget* anchor, const std::vector<std::string>& items, const std::string& current,
                 std::function<void(const std::string&)> chosen);
  void toggle_keys();
  bool keys_shown() const { return keys_shown_; }
  /// Something was folded, hidden or grew; everything is placed again before the next drawing.
  void layout_changed() { layout_pending_ = true; }
  /// To be called before widgets are removed: nothing may point to them any more.
  void let_go();
  /// The widget that the keyboard acts on, or null.
  nanogui::Widget* focus() const { return mFocusPath.empty() ? nullptr : mFocusPath.front(); }
  nanogui::Widget* under_pointer() { return findWidget(mMousePos); }
  void focus_next(bool backwards);
  bool editing() const;                  ///< text is being typed
  void focus_on(const std::string& id);  ///< of a widget in the panel; nothing happens when there is none

  void draw_all();  ///< into the bound framebuffer, which has a stencil
  /// When the hint beside the pointer is due [s from now]; negative: it is shown, or there is none.
  double hint_due_s() const;
  void draw(NVGcontext*) override;
  bool keyboardEvent(int key, int scancode, int action, int modifiers) override;

 private:
  void place();
  void tidy();
  std::vector<nanogui::Widget*> ring();
  std::string hint_at_pointer();
  void draw_hint(NVGcontext*);
  struct KeyPage {
    int columns = 1, per_column = 1, pages = 1;
  };
  KeyPage key_page() const;  ///< how many keys the window has room for
  void draw_keys(NVGcontext*) const;
  ScrollArea* panel_;
  ListPopup* popup_ = nullptr;
  int keys_page_ = 0;
  bool layout_pending_ = true, keys_shown_ = false, swallow_character_ = false;
  double moved_s_ = 0;
};

}  // namespace pellucid::sandbox
