#pragma once

#include <cmath>
#include <cstddef>
#include <string_view>

#include <fmt/format.h>

#include "algorithms/scene/images/image.hpp"
#include "gl/error.hpp"

namespace pellucid {

/// Throws RuntimeError with the pixel of the first value that is infinite or not a number. `what`: "the frame", in the
/// message.
inline void require_finite(const Image& image, std::string_view what) {
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (std::isfinite(image.pixels[i])) continue;
    const auto channels = static_cast<std::size_t>(image.channels), width = static_cast<std::size_t>(image.width);
    const std::size_t pixel = i / channels;
    throw RuntimeError(fmt::format("{} has a value that is not finite ({}{}) at pixel ({}, {}), channel {}", what,
                                   image.pixels[i],
                                   std::isinf(image.pixels[i]) ? "; 16-bit floats hold up to 65504" : "", pixel % width,
                                   pixel / width, i % channels));
  }
}

}  // namespace pellucid
