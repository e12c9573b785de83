#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "algorithms/scene/images/image.hpp"

namespace pellucid::sandbox {

/// A rectangle of pixels: columns [x0, x1), rows [y0, y1).
struct PixelBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool empty() const { return x1 <= x0 || y1 <= y0; }
  bool operator==(const PixelBox&) const = default;
};

/// The pixels of a box in figures, by channel (red, green, blue, luminance).
struct BoxStatistics {
  static constexpr int kBins = 64;
  std::size_t pixels = 0;
  std::size_t not_finite = 0;  ///< values that are left out of all below
  std::array<double, 4> min{}, max{}, mean{}, deviation{};
  double low = 0, high = 1;                                ///< the histogram's ends: the least and largest of R, G, B
  std::array<std::array<std::size_t, kBins>, 3> counts{};  ///< of R, G, B
};

/// The part of `box` that lies in the image counts. An image of one channel is grey.
BoxStatistics statistics_of(const Image&, const PixelBox& box);

}  // namespace pellucid::sandbox
