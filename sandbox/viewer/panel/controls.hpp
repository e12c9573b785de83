#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <nanogui/textbox.h>

#include "sandbox/viewer/panel/reachable.hpp"

/// The panel's controls. Each is changed by mouse and by keys; Enter or Space does what a click does.
namespace pellucid::sandbox {

/// A line of text to edit. The typed text is offered on Enter or when the focus leaves; a refusal keeps the text, in
/// red, with the reason in `reason()`. Escape takes it back. Up and Down step.
class Field : public nanogui::TextBox, public Reachable {
 public:
  explicit Field(nanogui::Widget* parent);
  std::function<std::string(const std::string&)> offer;  ///< returns the reason of a refusal, or nothing
  std::function<void(const std::string&)> typed;         ///< at every key, for a search
  std::function<void(int)> step;
  /// The text that stands there unless somebody is typing.
  void show(const std::string&);
  const std::string& reason() const { return reason_; }
  bool editing() const { return mFocused; }
  bool type(unsigned codepoint) override;
  bool keyboardEvent(int key, int scancode, int action, int modifiers) override;
  bool keyboardCharacterEvent(unsigned codepoint) override;
  bool focusEvent(bool focused) override;
  void draw(NVGcontext*) override;

 private:
  std::string shown_, reason_;
  bool just_refused_ = false;
};

/// A bar to drag; its position is a share in [0, 1].
class SliderBar : public Control {
 public:
  using Control::Control;
  std::function<void(double)> dragged;  ///< the new share
  std::function<void(double)> nudge;    ///< by how many steps
  std::function<bool(unsigned)> digit;  ///< text typed over it
  void set_share(double share) { share_ = share; }
  bool mouseButtonEvent(const nanogui::Vector2i&, int button, bool down, int modifiers) override;
  bool mouseDragEvent(const nanogui::Vector2i&, const nanogui::Vector2i&, int button, int modifiers) override;
  bool keyboardEvent(int key, int scancode, int action, int modifiers) override;
  bool type(unsigned codepoint) override { return digit && digit(codepoint); }
  void draw(NVGcontext*) override;

 private:
  void drag_to(int x);
  double share_ = 0;
};

class CheckBox : public Control {
 public:
  using Control::Control;
  std::function<void(bool)> changed;
  void set_checked(bool checked) { checked_ = checked; }
  bool mouseButtonEvent(const nanogui::Vector2i&, int button, bool down, int modifiers) override;
  bool keyboardEvent(int key, int scancode, int action, int modifiers) override;
  void draw(NVGcontext*) override;

 private:
  bool checked_ = false;
};

/// One of several words. Arrows change it; Enter, Space or a click open the list.
class Choice : public Control {
 public:
  using Control::Control;
  std::function<void(const std::string&)> chosen;
  std::vector<std::string> items;
  std::string current;
  bool mouseButtonEvent(const nanogui::Vector2i&, int button, bool down, int modifiers) override;
  bool keyboardEvent(int key, int scancode, int action, int modifiers) override;
  void draw(NVGcontext*) override;

 private:
  void open();
  void move(int by);
};

class PushButton : public Control {
 public:
  PushButton(nanogui::Widget* parent, std::string words, std::function<void()> pushed)
      : Control(parent), words_(std::move(words)), pushed_(std::move(pushed)) {}
  void set_words(std::string words) { words_ = std::move(words); }
  bool lit = false;  ///< drawn as switched on
  bool mouseButtonEvent(const nanogui::Vector2i&, int button, bool down, int modifiers) override;
  bool keyboardEvent(int key, int scancode, int action, int modifiers) override;
  void draw(NVGcontext*) override;

 private:
  std::string words_;
  std::function<void()> pushed_;
  bool down_ = false;
};

/// Words that are not edited: wrapped, as high as they need.
class Note : public nanogui::Widget {
 public:
  using nanogui::Widget::Widget;
  std::string words;
  bool bad = false;
  nanogui::Vector2i preferredSize(NVGcontext*) const override;
  void draw(NVGcontext*) override;
};

}  // namespace pellucid::sandbox
