#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "algorithms/scene/images/image.hpp"

namespace pellucid::sweeps {

/// Throws InputError unless the image has 1, 3 or 4 channels, at least one pixel, and every channel of every pixel is
/// finite; the message begins with `what` and names the first offending pixel.
void check_pixels(const Image& image, const std::string& what);

/// Throws InputError when the images differ in width or height.
void check_same_size(const Image& reference, const Image& other, const std::string& what);

/// Channel c in {0, 1, 2} of the pixel at `pixel`; a grey image stands for three equal channels.
inline float channel(const Image& image, const float* pixel, int c) {
  return pixel[image.channels == 1 ? 0 : c];
}

/// IEC 61966-2-1, for values in [0, 1].
template <typename Real>
Real srgb_to_linear(Real v) {
  return v <= Real(0.04045) ? v / Real(12.92) : std::pow((v + Real(0.055)) / Real(1.055), Real(2.4));
}
template <typename Real>
Real linear_to_srgb(Real v) {
  return v <= Real(0.0031308) ? v * Real(12.92) : Real(1.055) * std::pow(v, Real(1) / Real(2.4)) - Real(0.055);
}

/// Rec. 709 weights: the luminance of linear components, the luma of encoded ones.
template <typename Real>
Real rec709(Real r, Real g, Real b) {
  return Real(0.2126) * r + Real(0.7152) * g + Real(0.0722) * b;
}

}  // namespace pellucid::sweeps
