#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include <tbb/parallel_sort.h>

#include "gl/error.hpp"
#include "sweeps/metrics/flip.hpp"

namespace pellucid::sweeps {

FlipStatistics pool(std::span<const float> errors) {
  if (errors.empty()) throw InputError("no pixels to pool FLIP errors over");
  std::vector<float> sorted(errors.begin(), errors.end());
  tbb::parallel_sort(sorted.begin(), sorted.end());
  double sum = 0;
  for (float e : sorted)
    sum += e;
  FlipStatistics out;
  out.mean = sum / static_cast<double>(sorted.size());
  out.min = sorted.front();
  out.max = sorted.back();
  const std::pair<double, double*> percentiles[] = {
      {0.25, &out.weighted_q1}, {0.5, &out.weighted_median}, {0.75, &out.weighted_q3}};
  std::size_t i = 0;
  double running = 0;
  for (const auto& [p, value] : percentiles) {
    if (sum <= 0) break;
    while (i < sorted.size() && running + sorted[i] <= p * sum)
      running += sorted[i++];
    *value = sorted[std::min(i, sorted.size() - 1)];
  }
  return out;
}

Image error_colors(const Image& errors) {
  // Anchors of a ramp whose L* rises from 0 to 97, each placed where its L* belongs.
  struct Anchor {
    float at, rgb[3];
  };
  static constexpr Anchor kRamp[] = {{0.000f, {0.00f, 0.00f, 0.02f}}, {0.085f, {0.10f, 0.05f, 0.27f}},
                                     {0.202f, {0.27f, 0.07f, 0.45f}}, {0.307f, {0.45f, 0.13f, 0.49f}},
                                     {0.411f, {0.64f, 0.19f, 0.47f}}, {0.522f, {0.83f, 0.27f, 0.40f}},
                                     {0.640f, {0.95f, 0.43f, 0.35f}}, {0.764f, {0.99f, 0.63f, 0.42f}},
                                     {0.880f, {0.99f, 0.81f, 0.57f}}, {1.000f, {0.99f, 0.98f, 0.78f}}};
  if (errors.channels != 1) throw InputError("an error map has one channel");
  Image out(errors.width, errors.height, 3);
  for (std::size_t i = 0; i < errors.pixels.size(); ++i) {
    const float e = std::clamp(errors.pixels[i], 0.0f, 1.0f);
    const Anchor* above = std::lower_bound(std::begin(kRamp) + 1, std::end(kRamp) - 1, e,
                                           [](const Anchor& anchor, float value) { return anchor.at < value; });
    const Anchor* below = above - 1;
    const float t = (e - below->at) / (above->at - below->at);
    for (std::size_t c = 0; c < 3; ++c)
      out.pixels[3 * i + c] = std::lerp(below->rgb[c], above->rgb[c], t);
  }
  return out;
}

}  // namespace pellucid::sweeps
