#include "sandbox/viewer/state/colors.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "gl/error.hpp"
#include "sweeps/metrics/pixels.hpp"

namespace pellucid::sandbox {

std::string color_at(std::span<const ParameterInfo> infos, std::size_t at) {
  if (at + 3 > infos.size() || !infos[at].name.ends_with(kColorChannels[0])) return "";
  const std::string stem = infos[at].name.substr(0, infos[at].name.size() - kColorChannels[0].size());
  for (std::size_t c = 0; c < 3; ++c) {
    const ParameterInfo& info = infos[at + c];
    const bool fits = info.name == stem + std::string(kColorChannels[c]) && info.type == ValueType::real &&
                      info.min == infos[at].min && info.max == infos[at].max;
    if (!fits) return "";
  }
  return stem;
}

HueColor to_hue(const glm::dvec3& rgb) {
  const double most = std::max({rgb.x, rgb.y, rgb.z}), least = std::min({rgb.x, rgb.y, rgb.z}), span = most - least;
  if (span <= 0) return {0, 0, most};
  double sixth = 0;
  if (most == rgb.x) {
    sixth = (rgb.y - rgb.z) / span;
  } else if (most == rgb.y) {
    sixth = (rgb.z - rgb.x) / span + 2;
  } else {
    sixth = (rgb.x - rgb.y) / span + 4;
  }
  return {sixth < 0 ? sixth / 6 + 1 : sixth / 6, span / most, most};
}

glm::dvec3 from_hue(const HueColor& color) {
  glm::dvec3 out{0.0};
  for (int c = 0; c < 3; ++c) {
    // Each channel is a trapezoid over the circle of hues, a third of it after the one before.
    const double at = std::fmod(color.hue - c / 3.0 + 1.5, 1.0) - 0.5;
    const double pure = std::clamp(2 - 6 * std::abs(at), 0.0, 1.0);
    out[c] = color.value * (1 - color.saturation * (1 - pure));
  }
  return out;
}

glm::dvec3 parse_color(const std::string& text) {
  const auto fail = [&]() -> InputError {
    return InputError(fmt::format("'{}' is no colour: write three numbers r, g, b, one for grey, or #rrggbb", text));
  };
  if (text.starts_with('#')) {
    unsigned bits = 0;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + 1, end, bits, 16);
    if (text.size() != 7 || error != std::errc{} || stop != end) throw fail();
    const auto channel = [&](unsigned shift) { return sweeps::srgb_to_linear(((bits >> shift) & 0xffU) / 255.0); };
    return {channel(16), channel(8), channel(0)};
  }
  std::vector<double> numbers;
  const char *at = text.data(), *end = text.data() + text.size();
  while (at != end) {
    if (*at == ' ' || *at == ',') {
      ++at;
      continue;
    }
    double value = 0;
    const auto [stop, error] = std::from_chars(at, end, value);
    if (error != std::errc{} || !std::isfinite(value) || numbers.size() == 3) throw fail();
    numbers.push_back(value);
    at = stop;
  }
  if (numbers.size() == 1) return glm::dvec3(numbers[0]);
  if (numbers.size() != 3) throw fail();
  return {numbers[0], numbers[1], numbers[2]};
}

std::string color_text(const glm::dvec3& rgb) {
  return fmt::format("{}, {}, {}", rgb.x, rgb.y, rgb.z);
}

}  // namespace pellucid::sandbox
