#include "sandbox/viewer/panel/parameter_row.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "gl/error.hpp"
#include "sandbox/viewer/panel/desk.hpp"

namespace pellucid::sandbox {

using nanogui::Vector2i;

namespace {

constexpr int kDot = 12, kLabel = 128, kField = 66;

double number(const Value& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  if (const auto* real = std::get_if<double>(&value)) return *real;
  return 0;
}

/// As many digits as a step of `step` needs, so that a dragged value reads well.
double rounded(double value, double step) {
  const double unit = std::pow(10.0, std::floor(std::log10(step)));
  // Through text: 0.1 and not 0.1000000001.
  const std::string text = fmt::format("{:.12g}", std::round(value / unit) * unit);
  double out = value;
  std::from_chars(text.data(), text.data() + text.size(), out);
  return out;
}

NVGcolor cost_color(Change change) {
  switch (change) {
    case Change::uniform:
      return nvgRGB(120, 190, 120);
    case Change::program:
      return nvgRGB(225, 190, 80);
    case Change::precompute:
      return nvgRGB(225, 110, 90);
  }
  return {};
}

const char* cost_words(Change change) {
  switch (change) {
    case Change::uniform:
      return "A change shows in the next frame.";
    case Change::program:
      return "A change compiles the shaders again.";
    case Change::precompute:
      return "A change repeats the precomputation.";
  }
  return "";
}

}  // namespace

std::string parameter_hint(const std::string& name, const ParameterInfo& info) {
  std::string text = info.symbol.empty() ? name : fmt::format("{} ({})", name, info.symbol);
  text += fmt::format(": {}.", info.doc);
  if (info.type == ValueType::integer || info.type == ValueType::real) {
    text += fmt::format("\nRange [{:g}, {:g}]{}{}, default {}.", info.min, info.max, info.unit.empty() ? "" : " ",
                        info.unit, to_text(info.default_value));
  } else {
    text += fmt::format("\nDefault {}.", to_text(info.default_value));
  }
  if (!info.cite.empty()) text += "\n" + info.cite + ".";
  text += fmt::format("\n{}", cost_words(info.when));
  return text;
}

ParameterRow::ParameterRow(nanogui::Widget* parent, std::string name, const ParameterInfo& info,
                           const ParameterModel& model)
    : Control(parent), name_(std::move(name)), info_(info), model_(model) {
  setId("row " + name_);
  const std::string hint = parameter_hint(name_, info_);
  set_hint(hint);
  if (info_.type == ValueType::boolean) {
    check_ = new CheckBox(this);
    check_->changed = [this](bool on) { model_.set(name_, on); };
    check_->set_hint(hint);
    check_->setId(name_);
  } else if (info_.type == ValueType::choice) {
    choice_ = new Choice(this);
    choice_->items = info_.choices;
    choice_->chosen = [this](const std::string& item) { model_.set(name_, item); };
    choice_->set_hint(hint);
    choice_->setId(name_);
  } else {
    slider_ = new SliderBar(this);
    slider_->set_hint(hint);
    slider_->setId(name_);
    slider_->dragged = [this](double share) { model_.set(name_, value_at(share)); };
    slider_->nudge = [this](double steps) { model_.set(name_, stepped(steps)); };
    field_ = new Field(this);
    field_->set_hint(hint);
    field_->setId(name_ + " field");
    field_->offer = [this](const std::string& text) { return offered(text); };
    field_->step = [this](int steps) { model_.set(name_, stepped(steps)); };
    slider_->digit = [this](unsigned codepoint) {
      const bool begins = (codepoint >= '0' && codepoint <= '9') || codepoint == '-' || codepoint == '.';
      return begins && field_->type(codepoint);
    };
  }
  refresh();
}

// In a narrow window the label gives way, so that the slider and its field stay apart.
int ParameterRow::label_width() const {
  return std::min(kLabel, mSize.x() * 2 / 5);
}

bool ParameterRow::matches(const std::string& search) const {
  return name_.find(search) != std::string::npos || info_.symbol.find(search) != std::string::npos ||
         info_.doc.find(search) != std::string::npos;
}

bool ParameterRow::differs() const {
  return to_text(model_.get(name_)) != to_text(info_.default_value);
}

void ParameterRow::reset() {
  if (differs()) model_.set(name_, info_.default_value);
}

// A range such as [0, 1000] around a default of 1 would leave the first pixel for all that matters.
bool ParameterRow::curved() const {
  const double standard = number(info_.default_value);
  return info_.min >= 0 && standard > info_.min && (info_.max - info_.min) / (standard - info_.min) > 20;
}

double ParameterRow::share_of(double value) const {
  const double share = std::clamp((value - info_.min) / (info_.max - info_.min), 0.0, 1.0);
  return curved() ? std::cbrt(share) : share;
}

Value ParameterRow::value_at(double share) const {
  const double along = curved() ? share * share * share : share;
  const double value = info_.min + along * (info_.max - info_.min);
  if (info_.type == ValueType::integer) return static_cast<std::int64_t>(std::llround(value));
  // A pixel of the bar is about a hundredth; near the start of a curve it is far less.
  const double step = std::max((info_.max - info_.min) / 1000, 1e-12) * (curved() ? std::max(along, 1e-4) : 1.0);
  return std::clamp(rounded(value, step), info_.min, info_.max);
}

Value ParameterRow::stepped(double steps) const {
  const double now = number(model_.get(name_));
  if (info_.type == ValueType::integer) return static_cast<std::int64_t>(std::clamp(now + steps, info_.min, info_.max));
  if (curved()) return value_at(std::clamp(share_of(now) + steps / 100, 0.0, 1.0));
  const double step = (info_.max - info_.min) / 100;
  return std::clamp(rounded(now + steps * step, step / 10), info_.min, info_.max);
}

std::string ParameterRow::offered(const std::string& text) {
  std::string reason;
  try {
    const std::string owner = "this";
    const Value value = parse_value(info_, text, owner);
    model_.set(name_, value);
  } catch (const InputError& e) {
    reason = e.what();
    constexpr std::string_view kOwner = "this: ";
    if (reason.starts_with(kOwner)) reason.erase(0, kOwner.size());
  }
  if (auto* desk = dynamic_cast<Desk*>(screen())) desk->layout_changed();
  return reason;
}

void ParameterRow::refresh() {
  const Value value = model_.get(name_);
  if (check_ != nullptr) check_->set_checked(std::get<bool>(value));
  if (choice_ != nullptr) choice_->current = std::get<std::string>(value);
  if (slider_ != nullptr) {
    slider_->set_share(share_of(number(value)));
    field_->show(to_text(value));
  }
}

Vector2i ParameterRow::preferredSize(NVGcontext* ctx) const {
  int height = paint::kLine;
  if (field_ != nullptr && !field_->reason().empty()) {
    height += 4 + static_cast<int>(paint::paragraph(ctx, 0, 0, static_cast<float>(mFixedSize.x() - kDot),
                                                    field_->reason(), paint::warning(), paint::kSmallText, false));
  }
  return {mFixedSize.x(), height};
}

void ParameterRow::performLayout(NVGcontext*) {
  const int from = kDot + label_width(), rest = mSize.x() - from;
  if (check_ != nullptr) {
    check_->setPosition({from + 2, 0});
    check_->setSize({16, paint::kLine});
  }
  if (choice_ != nullptr) {
    choice_->setPosition({from, 0});
    choice_->setSize({rest, paint::kLine});
  }
  if (slider_ != nullptr) {
    slider_->setPosition({from, 0});
    slider_->setSize({std::max(10, rest - kField - 4), paint::kLine});
    field_->setPosition({from + rest - kField, 1});
    field_->setSize({kField, paint::kLine - 2});
  }
}

bool ParameterRow::mouseButtonEvent(const Vector2i& p, int button, bool down, int modifiers) {
  if (nanogui::Widget::mouseButtonEvent(p, button, down, modifiers)) return true;
  if (button == GLFW_MOUSE_BUTTON_1 && down && p.x() - mPos.x() < kDot + label_width()) {
    reset();
    return true;
  }
  return false;
}

void ParameterRow::draw(NVGcontext* ctx) {
  nvgBeginPath(ctx);
  nvgCircle(ctx, x() + 4, y() + paint::kLine / 2.0F, 3);
  nvgFillColor(ctx, cost_color(info_.when));
  nvgFill(ctx);
  const std::string label = info_.symbol.empty() ? info_.name : fmt::format("{}  {}", info_.name, info_.symbol);
  const bool changed = differs();
  const auto width = static_cast<float>(label_width());
  paint::line(ctx, x() + kDot, y(), width - 14, paint::kLine, label, changed ? paint::accent() : paint::text(),
              paint::kText, paint::Align::left, changed);
  // The arrow that goes back.
  if (changed) paint::line(ctx, x() + kDot + width - 15, y(), 14, paint::kLine, "×", paint::dim_text());
  if (field_ != nullptr && !field_->reason().empty()) {
    paint::paragraph(ctx, x() + kDot, y() + paint::kLine + 1, w() - kDot, field_->reason(), paint::warning(),
                     paint::kSmallText, true);
  }
  nanogui::Widget::draw(ctx);
}

}  // namespace pellucid::sandbox
