#include "plots/pictures/false_color.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <string>

#include <fmt/format.h>

#include "sweeps/metrics/flip.hpp"

namespace pellucid::plots {
namespace {

constexpr double kShown = 0.99;
constexpr float kNoValue = 0.55F;  // display-encoded; no colour of the ramp is grey

double round_up(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0}) {
    // As its shortest decimal: 5e-3, not 0.005000000000000001.
    if (step * power >= value * (1 - 1e-9)) return std::stod(fmt::format("{:.3g}", step * power));
  }
  return std::stod(fmt::format("{:.3g}", 10 * power));
}

}  // namespace

double color_range(const std::vector<const Image*>& maps) {
  double end = 0;
  for (const Image* map : maps) {
    assert(map->channels == 1);
    std::vector<float> values;
    std::copy_if(map->pixels.begin(), map->pixels.end(), std::back_inserter(values),
                 [](float v) { return std::isfinite(v); });
    if (values.empty()) continue;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(kShown * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    end = std::max(end, static_cast<double>(*at));
  }
  return end > 0 ? round_up(end) : 1;
}

Image false_colors(const Image& map, double range) {
  assert(map.channels == 1 && range > 0);
  Image scaled = map;
  for (float& value : scaled.pixels)
    value = std::isfinite(value) ? value / static_cast<float>(range) : 0.0F;
  Image colors = sweeps::error_colors(scaled);
  for (std::size_t i = 0; i < map.pixels.size(); ++i) {
    if (!std::isfinite(map.pixels[i]))
      std::fill_n(colors.pixels.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, kNoValue);
  }
  return colors;
}

}  // namespace pellucid::plots
