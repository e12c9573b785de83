#include "sandbox/viewer/panel/color_row.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "gl/error.hpp"
#include "sandbox/viewer/panel/desk.hpp"
#include "sweeps/metrics/pixels.hpp"

namespace pellucid::sandbox {

using nanogui::Vector2i;

namespace {

constexpr int kIndent = 12;
constexpr int kSwatch = 34;

NVGcolor shown(const glm::dvec3& linear) {
  const auto byte = [](double v) {
    return static_cast<unsigned char>(std::lround(255 * std::clamp(sweeps::linear_to_srgb(v), 0.0, 1.0)));
  };
  return nvgRGB(byte(linear.x), byte(linear.y), byte(linear.z));
}

double rounded_channel(double v) {
  const std::string text = fmt::format("{:.4g}", v);
  double out = v;
  std::from_chars(text.data(), text.data() + text.size(), out);
  return out;
}

}  // namespace

// ---- HuePad ----

void HuePad::show(const glm::dvec3& rgb, double most) {
  const HueColor now = to_hue(rgb);
  most_ = most;
  // Grey has no hue of its own, and black no saturation: those of before stay, so that a drag can go on.
  if (now.value > 0 && now.saturation > 0) {
    color_ = now;
  } else if (now.value > 0) {
    color_ = {color_.hue, 0, now.value};
  } else {
    color_.value = 0;
  }
}

void HuePad::choose(HueColor color) {
  color.saturation = std::clamp(color.saturation, 0.0, 1.0);
  color.value = std::clamp(color.value, 0.0, most_);
  color_ = color;
  if (chosen) chosen(color);
}

void HuePad::drag_to(const Vector2i& p) {
  const double along = static_cast<double>(p.x() - mPos.x()) / std::max(1, mSize.x() - kSwatch);
  const double down = static_cast<double>(p.y() - mPos.y()) / kHeight;
  // From black there is nothing to colour.
  const double value = color_.value > 0 ? color_.value : most_ / 2;
  choose({std::clamp(along, 0.0, 0.9999), 1 - std::clamp(down, 0.0, 1.0), value});
}

bool HuePad::mouseButtonEvent(const Vector2i& p, int button, bool down, int) {
  if (button != GLFW_MOUSE_BUTTON_1) return false;
  if (down) {
    requestFocus();
    drag_to(p);
  }
  return true;
}

bool HuePad::mouseDragEvent(const Vector2i& p, const Vector2i&, int, int) {
  drag_to(p);
  return true;
}

bool HuePad::keyboardEvent(int key, int, int action, int modifiers) {
  if (action != GLFW_PRESS && action != GLFW_REPEAT) return false;
  const double by = (modifiers & GLFW_MOD_SHIFT) != 0 ? 0.1 : 0.01;
  HueColor next = color_;
  if (key == GLFW_KEY_LEFT || key == GLFW_KEY_RIGHT) {
    next.hue = std::fmod(next.hue + (key == GLFW_KEY_RIGHT ? by : -by) + 1, 1.0);
  } else if (key == GLFW_KEY_UP || key == GLFW_KEY_DOWN) {
    next.saturation += key == GLFW_KEY_UP ? by : -by;
  } else if (key == GLFW_KEY_PAGE_UP || key == GLFW_KEY_PAGE_DOWN) {
    next.value = next.value > 0 ? next.value * (key == GLFW_KEY_PAGE_UP ? 1 + 5 * by : 1 / (1 + 5 * by)) : most_ / 100;
  } else {
    return false;
  }
  choose(next);
  return true;
}

void HuePad::draw(NVGcontext* ctx) {
  const float width = w() - kSwatch, height = kHeight;
  constexpr int kSixths = 6;
  const NVGcolor grey = shown(glm::dvec3(1));
  for (int i = 0; i < kSixths; ++i) {
    const float left = x() + width * static_cast<float>(i) / kSixths, step = width / kSixths;
    const NVGcolor from = shown(from_hue({i / 6.0, 1, 1})), to = shown(from_hue({(i + 1) % kSixths / 6.0, 1, 1}));
    nvgBeginPath(ctx);
    nvgRect(ctx, left, y(), step + 1, height);
    nvgFillPaint(ctx, nvgLinearGradient(ctx, left, y(), left + step, y(), from, to));
    nvgFill(ctx);
  }
  nvgBeginPath(ctx);
  nvgRect(ctx, x(), y(), width + 1, height);
  nvgFillPaint(ctx, nvgLinearGradient(ctx, x(), y(), x(), y() + height, nvgTransRGBA(grey, 0), grey));
  nvgFill(ctx);
  // The colour in its own scale: absorption and radiance go beyond what a display shows.
  const glm::dvec3 rgb = from_hue(color_) / std::max(1.0, color_.value);
  paint::box(ctx, x() + width + 5, y(), kSwatch - 5, height, shown(rgb));
  const float at_x = x() + static_cast<float>(color_.hue) * width;
  const float at_y = y() + static_cast<float>(1 - color_.saturation) * height;
  for (const bool inner : {false, true}) {
    nvgBeginPath(ctx);
    nvgCircle(ctx, at_x, at_y, inner ? 4.0F : 5.0F);
    nvgStrokeWidth(ctx, 1.5F);
    nvgStrokeColor(ctx, inner ? nvgRGB(255, 255, 255) : nvgRGB(0, 0, 0));
    nvgStroke(ctx);
  }
}

// ---- ColorRow ----

ColorRow::ColorRow(nanogui::Widget* parent, std::string name, const ParameterInfo& red, const ParameterModel& model)
    : Control(parent), label_(name), red_(red), model_(model), pad_(new HuePad(this)), field_(new Field(this)) {
  for (std::size_t c = 0; c < 3; ++c)
    channels_[c] = name + std::string(kColorChannels[c]);
  setId("row " + name);
  const std::string hint = fmt::format(
      "{}: a colour, linear Rec. 709, in [{:g}, {:g}]{}{}.\nDrag, or Left and Right: hue; Up and Down: saturation; "
      "Page Up "
      "and Page Down: brightness. The field takes r, g, b or #rrggbb.",
      name, red.min, red.max, red.unit.empty() ? "" : " ", red.unit);
  set_hint(hint);
  pad_->setId(name);
  pad_->set_hint(hint);
  pad_->chosen = [this](const HueColor& color) { set(from_hue(color)); };
  field_->setId(name + " field");
  field_->set_hint(hint);
  field_->offer = [this](const std::string& text) { return offered(text); };
  if (const std::size_t dot = label_.rfind('.'); dot != std::string::npos) label_.erase(0, dot + 1);
  refresh();
}

glm::dvec3 ColorRow::value() const {
  glm::dvec3 out{0.0};
  for (int c = 0; c < 3; ++c) {
    const Value now = model_.get(channels_[static_cast<std::size_t>(c)]);
    if (const auto* real = std::get_if<double>(&now)) out[c] = *real;
  }
  return out;
}

void ColorRow::set(const glm::dvec3& rgb) {
  std::vector<std::pair<std::string, Value>> values;
  for (int c = 0; c < 3; ++c)
    values.emplace_back(channels_[static_cast<std::size_t>(c)],
                        std::clamp(rounded_channel(rgb[c]), red_.min, red_.max));
  model_.set_together(values);
}

std::string ColorRow::offered(const std::string& text) {
  std::string reason;
  try {
    const glm::dvec3 rgb = parse_color(text);
    // All three are judged before one is taken.
    for (int c = 0; c < 3; ++c)
      checked(red_, rgb[c], "this");
    model_.set_together({{channels_[0], rgb.x}, {channels_[1], rgb.y}, {channels_[2], rgb.z}});
  } catch (const InputError& e) {
    reason = e.what();
  }
  if (auto* desk = dynamic_cast<Desk*>(screen())) desk->layout_changed();
  return reason;
}

void ColorRow::refresh() {
  const glm::dvec3 rgb = value();
  pad_->show(rgb, red_.max);
  field_->show(color_text(rgb));
}

Vector2i ColorRow::preferredSize(NVGcontext* ctx) const {
  int height = paint::kLine + HuePad::kHeight + 4;
  if (!field_->reason().empty()) {
    height += 4 + static_cast<int>(paint::paragraph(ctx, 0, 0, static_cast<float>(mFixedSize.x() - kIndent),
                                                    field_->reason(), paint::warning(), paint::kSmallText, false));
  }
  return {mFixedSize.x(), height};
}

void ColorRow::performLayout(NVGcontext*) {
  const int label = mSize.x() * 2 / 5;
  field_->setPosition({label, 1});
  field_->setSize({std::max(20, mSize.x() - label), paint::kLine - 2});
  pad_->setPosition({kIndent, paint::kLine + 2});
  pad_->setSize({std::max(20, mSize.x() - kIndent), HuePad::kHeight});
}

void ColorRow::draw(NVGcontext* ctx) {
  paint::line(ctx, x() + kIndent, y(), static_cast<float>(mSize.x()) * 0.4F - kIndent - 4, paint::kLine, label_,
              paint::text());
  if (!field_->reason().empty()) {
    paint::paragraph(ctx, x() + kIndent, y() + paint::kLine + HuePad::kHeight + 5, w() - kIndent, field_->reason(),
                     paint::warning(), paint::kSmallText, true);
  }
  nanogui::Widget::draw(ctx);
}

}  // namespace pellucid::sandbox
