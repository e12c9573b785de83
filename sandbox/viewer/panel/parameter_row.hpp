#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "algorithms/parameters.hpp"
#include "sandbox/viewer/panel/controls.hpp"

namespace pellucid::sandbox {

/// The state that a row reads and changes. Names are full, with their prefix.
struct ParameterModel {
  std::function<Value(const std::string& name)> get;
  std::function<void(const std::string& name, const Value&)> set;
  std::function<void(const std::vector<std::pair<std::string, Value>>&)> set_together;
};

/// One parameter: a dot that says what a change costs, the name (marked where it differs from its default; a click
/// resets), and the control that its type asks for.
class ParameterRow : public Control {
 public:
  ParameterRow(nanogui::Widget* parent, std::string name, const ParameterInfo&, const ParameterModel&);
  const std::string& name() const { return name_; }
  bool matches(const std::string& search) const;
  bool differs() const;
  void reset();
  /// Takes the value from the model again.
  void refresh();
  bool reachable() const override { return false; }  // its controls are
  nanogui::Vector2i preferredSize(NVGcontext*) const override;
  void performLayout(NVGcontext*) override;
  bool mouseButtonEvent(const nanogui::Vector2i&, int button, bool down, int modifiers) override;
  void draw(NVGcontext*) override;

 private:
  double share_of(double value) const;
  Value value_at(double share) const;
  Value stepped(double steps) const;
  std::string offered(const std::string& text);
  bool curved() const;
  int label_width() const;
  std::string name_;
  ParameterInfo info_;
  const ParameterModel& model_;
  SliderBar* slider_ = nullptr;
  Field* field_ = nullptr;
  CheckBox* check_ = nullptr;
  Choice* choice_ = nullptr;
};

/// All that is known of a parameter, as the hint shows it.
std::string parameter_hint(const std::string& name, const ParameterInfo&);

}  // namespace pellucid::sandbox
