#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "algorithms/scene/images/image.hpp"

namespace pellucid::sweeps::testing {

using Color = std::array<double, 3>;

inline Image picture(int width, int height, const std::function<Color(int x, int y)>& color) {
  Image out(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (std::size_t c = 0; c < 3; ++c)
        out.at(x, y)[c] = static_cast<float>(color(x, y)[c]);
  return out;
}

inline Image flat(int width, int height, const Color& color) {
  return picture(width, height, [&](int, int) { return color; });
}

/// A reference with waves, a gradient and a checkerboard in blue, and a test in which each of them is off;
/// display-encoded, or over about ten stops of radiance.
struct Pair {
  Image reference, test;
};
inline Pair waves(int width, int height, bool scene_linear) {
  const auto reference = [&](int x, int y) {
    const double u = static_cast<double>(x) / width, v = static_cast<double>(y) / height;
    return Color{0.5 + 0.45 * std::sin(9 * u + 4 * v * v), 0.15 + 0.8 * u * v, (x / 8 + y / 8) % 2 == 0 ? 0.85 : 0.2};
  };
  const auto test = [&](int x, int y) {
    const double u = static_cast<double>(x) / width, v = static_cast<double>(y) / height;
    const Color r = reference(x, y);
    return Color{r[0] * (0.8 + 0.15 * std::cos(31 * v)), r[1] + 0.05 * std::sin(40 * u * v),
                 (x / 8 + y / 8) % 2 == 0 ? 0.75 : 0.25};
  };
  const auto encode = [&](const Color& c) {
    const auto radiance = [](double v) { return std::exp2(10 * v - 6); };
    return scene_linear ? Color{radiance(c[0]), radiance(c[1]), radiance(c[2])} : c;
  };
  return {picture(width, height, [&](int x, int y) { return encode(reference(x, y)); }),
          picture(width, height, [&](int x, int y) { return encode(test(x, y)); })};
}

inline double mean(const std::vector<float>& values) {
  double sum = 0;
  for (float v : values)
    sum += v;
  return sum / static_cast<double>(values.size());
}

}  // namespace pellucid::sweeps::testing
