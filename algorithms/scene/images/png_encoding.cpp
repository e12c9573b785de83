#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "algorithms/scene/images/picture_file.hpp"

namespace pellucid {
namespace {

constexpr double kUsualGamma = 1 / 2.2;  // what writers of sRGB state beside, or in place of, an sRGB chunk

/// IEC 61966-2-1.
double srgb_encoded(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
}

}  // namespace

void encode_as_srgb(PictureFile& file) {
  if (!file.png) return;
  const PngColor& color = *file.png;
  if (!color.icc_profile.empty() && !color.srgb)
    file.notes.push_back(
        fmt::format("its ICC profile '{}' is not applied: the values are taken for sRGB", color.icc_profile));
  if (color.other_primaries)
    file.notes.emplace_back("its cHRM chunk names other primaries than sRGB's; it is not applied");
  if (!color.gamma || std::abs(*color.gamma - kUsualGamma) < 0.01) return;
  Image& image = file.image;
  const int colors = std::min(image.channels, 3);
  std::vector<float> encoded(65536, std::numeric_limits<float>::quiet_NaN());  // by the stored value, in 16 bits
  for (std::size_t i = 0; i < image.pixels.size(); i += static_cast<std::size_t>(image.channels)) {
    for (int c = 0; c < colors; ++c) {
      float& value = image.pixels[i + static_cast<std::size_t>(c)];
      float& known = encoded[static_cast<std::size_t>(std::lround(value * 65535.0F))];
      if (std::isnan(known))
        known = static_cast<float>(srgb_encoded(std::pow(static_cast<double>(value), 1 / *color.gamma)));
      value = known;
    }
  }
  file.notes.push_back(fmt::format("encoded as sRGB from the gamma {:.5g} that its header states", *color.gamma));
}

}  // namespace pellucid
