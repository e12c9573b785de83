#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>

#include <glm/glm.hpp>

#include "algorithms/parameters.hpp"
#include "sandbox/viewer/panel/controls.hpp"
#include "sandbox/viewer/panel/parameter_row.hpp"
#include "sandbox/viewer/state/colors.hpp"

namespace pellucid::sandbox {

/// A field of hues, to the right, and saturations, upwards; beside it the colour.
class HuePad : public Control {
 public:
  using Control::Control;
  static constexpr int kHeight = 44;
  std::function<void(const HueColor&)> chosen;
  /// `most`: the end of the channels' range.
  void show(const glm::dvec3& rgb, double most);
  bool mouseButtonEvent(const nanogui::Vector2i&, int button, bool down, int modifiers) override;
  bool mouseDragEvent(const nanogui::Vector2i&, const nanogui::Vector2i&, int button, int modifiers) override;
  bool keyboardEvent(int key, int scancode, int action, int modifiers) override;
  void draw(NVGcontext*) override;

 private:
  void drag_to(const nanogui::Vector2i&);
  void choose(HueColor);
  HueColor color_;
  double most_ = 1;
};

/// A colour whose channels are three parameters: the pad, and a field for its text. The channels' own rows stand below.
class ColorRow : public Control {
 public:
  /// `red` declares the first channel; `name` is full, with its prefix, and without the channel.
  ColorRow(nanogui::Widget* parent, std::string name, const ParameterInfo& red, const ParameterModel&);
  void refresh();
  bool reachable() const override { return false; }  // its controls are
  nanogui::Vector2i preferredSize(NVGcontext*) const override;
  void performLayout(NVGcontext*) override;
  void draw(NVGcontext*) override;

 private:
  glm::dvec3 value() const;
  void set(const glm::dvec3&);
  std::string offered(const std::string& text);
  std::array<std::string, 3> channels_;
  std::string label_;
  ParameterInfo red_;
  const ParameterModel& model_;
  HuePad* pad_;
  Field* field_;
};

}  // namespace pellucid::sandbox
