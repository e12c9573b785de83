#pragma once

#include <string>
#include <utility>

#include "sandbox/viewer/panel/reachable.hpp"

/// How the panel's widgets stand: one below the other, in sections that fold, in an area that scrolls.
namespace pellucid::sandbox {

/// Children from the top, each as wide as the stack and as high as it prefers to be at that width.
class Stack : public nanogui::Widget {
 public:
  explicit Stack(nanogui::Widget* parent, int gap = 3) : nanogui::Widget(parent), gap_(gap) {}
  nanogui::Vector2i preferredSize(NVGcontext*) const override;
  void performLayout(NVGcontext*) override;

 private:
  int gap_;
};

/// Children from the left, sharing the width equally; a label before them when there are words.
class Bar : public nanogui::Widget {
 public:
  explicit Bar(nanogui::Widget* parent, std::string words = {}) : nanogui::Widget(parent), words_(std::move(words)) {}
  nanogui::Vector2i preferredSize(NVGcontext*) const override;
  void performLayout(NVGcontext*) override;
  void draw(NVGcontext*) override;

 private:
  std::string words_;
};

/// A headline that folds what stands below it.
class Section : public nanogui::Widget {
 public:
  Section(nanogui::Widget* parent, const std::string& title, bool open = true);
  Stack* body() const { return body_; }
  bool open() const { return body_->visible(); }
  void set_open(bool open);
  nanogui::Vector2i preferredSize(NVGcontext*) const override;
  void performLayout(NVGcontext*) override;
  const std::string& title() const { return title_; }

 private:
  class Headline;
  std::string title_;
  Headline* headline_;
  Stack* body_;
};

/// Shows a part of one stack, which is higher.
class ScrollArea : public nanogui::Widget {
 public:
  explicit ScrollArea(nanogui::Widget* parent);
  Stack* content() const { return content_; }
  /// Scrolls just so far that `widget`, somewhere in the content, is seen.
  void reveal(const nanogui::Widget* widget);
  void performLayout(NVGcontext*) override;
  bool scrollEvent(const nanogui::Vector2i&, const nanogui::Vector2f& by) override;
  bool mouseDragEvent(const nanogui::Vector2i&, const nanogui::Vector2i&, int button, int modifiers) override;
  bool mouseButtonEvent(const nanogui::Vector2i&, int button, bool down, int modifiers) override;
  void draw(NVGcontext*) override;

 private:
  void scroll_to(int offset);
  Stack* content_;
  int offset_ = 0;
};

}  // namespace pellucid::sandbox
