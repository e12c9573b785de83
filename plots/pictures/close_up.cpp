#include "plots/pictures/close_up.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pellucid::plots {

Window brightest_window(const Image& image, int width, int height) {
  const int w = std::min(width, image.width), h = std::min(height, image.height);
  // Sums over all rectangles from the top left corner, so that a window costs four look-ups.
  const std::size_t stride = static_cast<std::size_t>(image.width) + 1;
  std::vector<double> sums(stride * (static_cast<std::size_t>(image.height) + 1));
  const auto sum = [&](int x, int y) -> double& {
    return sums[static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x)];
  };
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x)
      sum(x + 1, y + 1) = static_cast<double>(*image.at(x, y)) + sum(x, y + 1) + sum(x + 1, y) - sum(x, y);
  }
  Window best{0, 0, w, h};
  double largest = -HUGE_VAL;
  for (int y = 0; y + h <= image.height; ++y) {
    for (int x = 0; x + w <= image.width; ++x) {
      const double total = sum(x + w, y + h) - sum(x, y + h) - sum(x + w, y) + sum(x, y);
      if (total <= largest) continue;
      largest = total;
      best.x = x;
      best.y = y;
    }
  }
  return best;
}

Image crop(const Image& image, const Window& window) {
  assert(window.x >= 0 && window.x + window.width <= image.width);
  assert(window.y >= 0 && window.y + window.height <= image.height);
  Image out(window.width, window.height, image.channels);
  for (int y = 0; y < window.height; ++y)
    std::copy_n(image.at(window.x, window.y + y), window.width * image.channels, out.at(0, y));
  return out;
}

Image enlarge(const Image& image, int factor) {
  Image out(image.width * factor, image.height * factor, image.channels);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x)
      std::copy_n(image.at(x / factor, y / factor), image.channels, out.at(x, y));
  }
  return out;
}

Contrast contrast_for(const Image& image) {
  std::vector<float> values;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x)
      values.insert(values.end(), image.at(x, y), image.at(x, y) + std::min(image.channels, 3));
  }
  if (values.empty()) return {};
  const auto percentile = [&](double share) {
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), place, values.end());
    return *place;
  };
  const float low = percentile(0.01), high = percentile(0.99);
  if (!(high > low)) return {};
  const float margin = (high - low) / 8;  // a tenth of the range that is stretched, at either end
  return {low - margin, high + margin};
}

Image stretch(Image image, const Contrast& contrast) {
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < std::min(image.channels, 3); ++c) {
        float& value = image.at(x, y)[c];
        value = (value - contrast.low) / (contrast.high - contrast.low);
      }
    }
  }
  return image;
}

}  // namespace pellucid::plots
