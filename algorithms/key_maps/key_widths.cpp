#include "algorithms/key_maps/key_widths.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace pellucid::scattering {
namespace {

// True if lines between samples `factor` apart miss a Gaussian of this width by more than `omega`, at middles of fine
// texels.
bool misses(int factor, double width, double omega) {
  constexpr int kPhases = 32;
  const auto gaussian = [&](double x) { return std::exp(-0.5 * x * x / (width * width)); };
  for (int phase = 0; phase < kPhases; ++phase) {
    // The peak lies at 0, a coarse middle at `left`. The Gaussian bends most there; farther than its width away less is
    // missed.
    const double left = -factor * static_cast<double>(phase) / kPhases;
    for (double at = left - factor * std::ceil(width / factor); at < width; at += factor) {
      const double a = gaussian(at), b = gaussian(at + factor);
      for (int i = 0; i < factor; ++i) {
        const double t = (i + 0.5) / factor;
        if (std::abs(a + t * (b - a) - gaussian(at + t * factor)) > omega) return true;
      }
    }
  }
  return false;
}

}  // namespace

double least_width(int factor, double omega) {
  assert(factor >= 2 && omega > 0 && omega < 1);
  double low = 0.05 * factor, high = low;
  while (misses(factor, high, omega))
    high *= 2;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    (misses(factor, middle, omega) ? low : high) = middle;
  }
  return high;
}

KeyWidths::KeyWidths(int face_size, double omega) : widths_{0.0} {
  assert(face_size >= 2 && (face_size & (face_size - 1)) == 0);
  const double texel = std::numbers::pi / (2 * face_size);
  double of_texel = 0;
  for (int factor = 2; factor <= face_size; factor *= 2) {
    // Beyond this factor the width of a coarse texel no longer depends on it.
    if (factor <= 64) of_texel = least_width(factor, omega) / factor;
    widths_.push_back(of_texel * factor * texel);
  }
}

double KeyWidths::level(double width) const {
  const auto above = std::upper_bound(widths_.begin(), widths_.end(), width);
  if (above == widths_.end()) return levels();
  if (above == widths_.begin()) return 0;
  const double low = *(above - 1), high = *above;
  return static_cast<double>(above - widths_.begin() - 1) + (width * width - low * low) / (high * high - low * low);
}

}  // namespace pellucid::scattering
