#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include <glm/glm.hpp>

#include "algorithms/parameters.hpp"

/// Colours whose channels are parameters.
namespace pellucid::sandbox {

/// The end of a channel's name.
inline constexpr std::array<std::string_view, 3> kColorChannels{"_red", "_green", "_blue"};

/// The name of the colour whose channels are the three parameters that begin at `at`: "lamp" for lamp_red, lamp_green
/// and lamp_blue, in this order and of one range. Empty where none begins.
std::string color_at(std::span<const ParameterInfo>, std::size_t at);

/// Hue in [0, 1), saturation in [0, 1], and the largest channel; of channels that are not negative.
struct HueColor {
  double hue = 0, saturation = 0, value = 0;
};
HueColor to_hue(const glm::dvec3& rgb);
glm::dvec3 from_hue(const HueColor&);

/// "r, g, b" or "r g b"; one number for grey; "#rrggbb", sRGB-encoded. Throws InputError that says what it takes.
glm::dvec3 parse_color(const std::string& text);
/// The shortest text that parse_color() reads back.
std::string color_text(const glm::dvec3&);

}  // namespace pellucid::sandbox
