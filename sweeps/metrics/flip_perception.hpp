#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <vector>

namespace pellucid::sweeps::flip {

// The part of FLIP that looks at one image alone (references.bib: andersson2020): opponent colours blurred as the eye
// blurs them, then L*a*b* with the Hunt effect, and the strength of edges and points. FLIP compares two of these.
//
// The filters are applied separably, as the published tool does from version 1.2 on; the paper states them in 2D. Each
// is a product of 1D filters, the blue-yellow one a sum of two products, so both forms agree up to rounding.

/// 1D halves of the filters: weight [k] is for the offsets -k and +k.
struct Filters {
  explicit Filters(double pixels_per_degree);

  std::vector<float> achromatic, red_green;       ///< each sums to 1 over both sides
  std::array<std::vector<float>, 2> blue_yellow;  ///< the squares of their two sums add to 1
  std::vector<float> gauss;                       ///< sums to 1 over both sides
  std::vector<float> first;                       ///< odd: the positive side sums to 1
  std::vector<float> second;                      ///< even: positive weights sum to 1, negative ones to -1
};

/// The perceived picture: L*, Hunt-adjusted a* and b*, and the strengths of edges and points.
enum Channel { kLightness, kRedGreen, kBlueYellow, kEdge, kPoint, kChannels };
/// One row of each channel.
using Row = std::array<const float*, kChannels>;

/// Fills one row of linear Rec. 709 components in [0, 1].
using LinearSource = std::function<void(int y, float* r, float* g, float* b)>;

/// The filter passes over one image, with buffers that are reused from exposure to exposure.
class Perception {
 public:
  Perception(int width, int height, const Filters&);
  /// Calls sink(y, row) once for each row, from several threads; the row lives for the length of that call.
  void run(const LinearSource& linear, const std::function<void(int y, const Row&)>& sink);

 private:
  /// After the filters along x: the four of the colours, then the first and second derivative and the Gaussian of Y.
  enum Plane { kY, kCx, kCz0, kCz1, kDx, kDdx, kGauss, kPlanes };
  float* row(Plane plane, int y);
  void filter_along_x(const LinearSource&);

  int width_, height_;
  const Filters& filters_;
  std::size_t stride_;  ///< floats from row to row, whole vector blocks
  std::vector<float> planes_;
};

/// FLIP's error for a row of pixels, from the colours and features of both images.
void combine(const Row& reference, const Row& test, int width, float* error);

/// The ACES curve of HDR-FLIP, the pre-exposure of its published fit undone: (k0 x^2 + k1 x + k2) / (k3 x^2 + k4 x +
/// k5), clamped to [0, 1]; x >= 0.
inline constexpr std::array<double, 6> kAces = {0.6 * 0.6 * 2.51, 0.6 * 0.03, 0, 0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14};
inline float aces(double exposed) {
  constexpr auto k = [](std::size_t i) { return static_cast<float>(kAces[i]); };
  const float x = static_cast<float>(std::min(exposed, 1e4));  // the curve is at 1 long before; the square is finite
  return std::min((k(0) * x * x + k(1) * x + k(2)) / (k(3) * x * x + k(4) * x + k(5)), 1.0f);
}

}  // namespace pellucid::sweeps::flip
