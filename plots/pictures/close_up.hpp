#pragma once

#include "algorithms/scene/images/image.hpp"

/// A part of a picture, enlarged for print beside the same part of others.
namespace pellucid::plots {

/// Pixels from the top left corner.
struct Window {
  int x = 0, y = 0, width = 0, height = 0;
  bool operator==(const Window&) const = default;
};

/// The window of that size, or of the image's where that is smaller, with the largest sum of the first channel; of
/// equal ones the first from the top left.
Window brightest_window(const Image&, int width, int height);

/// `window` lies in the image.
Image crop(const Image&, const Window&);
/// Each pixel becomes a square of `factor` by `factor`.
Image enlarge(const Image&, int factor);

/// A straight line through display values: one for all pictures that are to be compared.
struct Contrast {
  float low = 0;   ///< becomes 0
  float high = 1;  ///< becomes 1
};
/// Stretches what lies between the 1st and the 99th percentile of R, G and B over the middle 80 % of the range. An even
/// image is left as it is.
Contrast contrast_for(const Image& display_encoded);
/// Applied to R, G and B, not to alpha; not clamped.
Image stretch(Image, const Contrast&);

}  // namespace pellucid::plots
