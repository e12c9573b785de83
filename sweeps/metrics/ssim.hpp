#pragma once

#include <vector>

#include "algorithms/scene/images/image.hpp"

namespace pellucid::sweeps {

/// The structural similarity index (references.bib: wang2004) of lumas in [0, 1] (dynamic range L = 1): an 11x11
/// Gaussian window of sigma 1.5 that sums to 1, K1 = 0.01, K2 = 0.03. Windows lie wholly inside the frame.
class SsimReference {
 public:
  static constexpr int kWindow = 11, kRadius = kWindow / 2;

  /// Throws InputError when the frame is smaller than a window. An image that is not `display_encoded` is clamped to
  /// [0, 1] and sRGB-encoded first.
  SsimReference(const Image& reference, bool display_encoded);

  /// SSIM of the windows' centres: (width - 10) x (height - 10), rows from the top. The sizes must agree.
  std::vector<double> map(const Image& test) const;
  int map_width() const { return width_ - 2 * kRadius; }
  int map_height() const { return height_ - 2 * kRadius; }

 private:
  int width_, height_;
  bool display_encoded_;
  std::vector<double> luma_;             ///< x, the whole frame
  std::vector<double> mean_, variance_;  ///< mu_x and sigma_x^2, of the size of the map
};

}  // namespace pellucid::sweeps
