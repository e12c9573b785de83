#include "sandbox/viewer/compare/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace pellucid::sandbox {

BoxStatistics statistics_of(const Image& image, const PixelBox& asked) {
  const PixelBox box{std::max(0, asked.x0), std::max(0, asked.y0), std::min(image.width, asked.x1),
                     std::min(image.height, asked.y1)};
  BoxStatistics out;
  if (box.empty()) return out;
  out.pixels = static_cast<std::size_t>(box.x1 - box.x0) * static_cast<std::size_t>(box.y1 - box.y0);
  const auto value = [&](const float* p, std::size_t channel) -> double {
    if (image.channels < 3) return p[0];
    if (channel < 3) return p[channel];
    return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
  };
  const auto each = [&](auto&& visit) {
    for (int y = box.y0; y < box.y1; ++y)
      for (int x = box.x0; x < box.x1; ++x)
        for (std::size_t c = 0; c < 4; ++c) {
          const double v = value(image.at(x, y), c);
          visit(c, v, std::isfinite(v));
        }
  };
  std::array<double, 4> sum{}, count{};
  out.min.fill(std::numeric_limits<double>::infinity());
  out.max.fill(-std::numeric_limits<double>::infinity());
  each([&](std::size_t c, double v, bool finite) {
    if (!finite) {
      out.not_finite += c < 3 ? 1 : 0;
      return;
    }
    out.min[c] = std::min(out.min[c], v);
    out.max[c] = std::max(out.max[c], v);
    sum[c] += v;
    count[c] += 1;
  });
  for (std::size_t c = 0; c < 4; ++c) {
    if (count[c] == 0) out.min[c] = out.max[c] = 0;
    out.mean[c] = count[c] > 0 ? sum[c] / count[c] : 0;
  }
  out.low = std::min({out.min[0], out.min[1], out.min[2]});
  out.high = std::max({out.max[0], out.max[1], out.max[2]});
  std::array<double, 4> squares{};
  each([&](std::size_t c, double v, bool finite) {
    if (!finite) return;
    squares[c] += (v - out.mean[c]) * (v - out.mean[c]);
    if (c == 3) return;
    const double share = out.high > out.low ? (v - out.low) / (out.high - out.low) : 0;
    ++out.counts[c][static_cast<std::size_t>(std::min<double>(BoxStatistics::kBins - 1, share * BoxStatistics::kBins))];
  });
  for (std::size_t c = 0; c < 4; ++c)
    out.deviation[c] = count[c] > 0 ? std::sqrt(squares[c] / count[c]) : 0;
  return out;
}

}  // namespace pellucid::sandbox
