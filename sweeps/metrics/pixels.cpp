#include "sweeps/metrics/pixels.hpp"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "gl/error.hpp"

namespace pellucid::sweeps {

void check_pixels(const Image& image, const std::string& what) {
  if (image.channels != 1 && image.channels != 3 && image.channels != 4)
    throw InputError(fmt::format("{}: {} channels; metrics take 1, 3 or 4", what, image.channels));
  if (image.width < 1 || image.height < 1)
    throw InputError(fmt::format("{}: empty image ({}x{})", what, image.width, image.height));
  const auto step = static_cast<std::size_t>(image.channels);
  const int compared = std::min(image.channels, 3);  // alpha is not, and may hold anything
  for (int y = 0; y < image.height; ++y) {
    const float* row = image.at(0, y);
    // 0 * v is 0 for a finite v and NaN otherwise, so one sum tells whether a row is sound.
    float probe = 0;
    for (std::size_t i = 0; i < step * static_cast<std::size_t>(image.width); i += step)
      for (int c = 0; c < compared; ++c)
        probe += 0.0f * row[i + static_cast<std::size_t>(c)];
    if (probe == 0) continue;
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < compared; ++c) {
        const float v = image.at(x, y)[c];
        if (std::isfinite(v)) continue;
        const char name = image.channels == 1 ? 'Y' : "RGB"[c];
        throw InputError(
            fmt::format("{}: channel {} of pixel ({}, {}) is {}, not a finite number", what, name, x, y, v));
      }
    }
  }
}

void check_same_size(const Image& reference, const Image& other, const std::string& what) {
  if (reference.width != other.width || reference.height != other.height)
    throw InputError(fmt::format("{} is {}x{} pixels, but the reference is {}x{}", what, other.width, other.height,
                                 reference.width, reference.height));
}

}  // namespace pellucid::sweeps
