#include "sweeps/metrics/ssim.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "gl/error.hpp"
#include "sweeps/metrics/pixels.hpp"

namespace pellucid::sweeps {
namespace {

constexpr int kWindow = SsimReference::kWindow, kRadius = SsimReference::kRadius;

std::size_t as_size(int n) {
  return static_cast<std::size_t>(n);
}

std::array<double, kWindow> window() {
  constexpr double kSigma = 1.5;
  std::array<double, kWindow> w;
  double sum = 0;
  for (int k = -kRadius; k <= kRadius; ++k)
    sum += w[as_size(k + kRadius)] = std::exp(-k * k / (2 * kSigma * kSigma));
  for (double& v : w)
    v /= sum;
  return w;
}

void for_rows(int height, const auto& body) {
  tbb::parallel_for(tbb::blocked_range<int>(0, height, 16), [&](const tbb::blocked_range<int>& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y)
      body(y);
  });
}

std::vector<double> luma(const Image& image, bool display_encoded) {
  std::vector<double> out(as_size(image.width) * as_size(image.height));
  for_rows(image.height, [&](int y) {
    for (int x = 0; x < image.width; ++x) {
      double rgb[3];
      for (int c = 0; c < 3; ++c) {
        const double v = channel(image, image.at(x, y), c);
        rgb[c] = display_encoded ? v : linear_to_srgb(std::clamp(v, 0.0, 1.0));
      }
      out[as_size(y) * as_size(image.width) + as_size(x)] = rec709(rgb[0], rgb[1], rgb[2]);
    }
  });
  return out;
}

/// The weighted means over all windows of a width x height frame whose values are value(i).
std::vector<double> window_means(int width, int height, const auto& value) {
  static const std::array<double, kWindow> w = window();
  const int inner_width = width - 2 * kRadius, inner_height = height - 2 * kRadius;
  std::vector<double> rows(as_size(inner_width) * as_size(height)), out(as_size(inner_width) * as_size(inner_height));
  for_rows(height, [&](int y) {
    std::vector<double> line(as_size(width));
    for (std::size_t x = 0; x < line.size(); ++x)
      line[x] = value(as_size(y) * as_size(width) + x);
    double* sum = rows.data() + as_size(y) * as_size(inner_width);
    for (std::size_t k = 0; k < w.size(); ++k)
      for (std::size_t x = 0; x < as_size(inner_width); ++x)
        sum[x] += w[k] * line[x + k];
  });
  for_rows(inner_height, [&](int y) {
    double* sum = out.data() + as_size(y) * as_size(inner_width);
    for (std::size_t k = 0; k < w.size(); ++k) {
      const double* line = rows.data() + (as_size(y) + k) * as_size(inner_width);
      for (std::size_t x = 0; x < as_size(inner_width); ++x)
        sum[x] += w[k] * line[x];
    }
  });
  return out;
}

}  // namespace

SsimReference::SsimReference(const Image& reference, bool display_encoded)
    : width_(reference.width), height_(reference.height), display_encoded_(display_encoded) {
  if (width_ < kWindow || height_ < kWindow)
    throw InputError(fmt::format("ssim needs at least {0}x{0} pixels, the reference has {1}x{2}; leave ssim out",
                                 kWindow, width_, height_));
  luma_ = luma(reference, display_encoded);
  mean_ = window_means(width_, height_, [&](std::size_t i) { return luma_[i]; });
  variance_ = window_means(width_, height_, [&](std::size_t i) { return luma_[i] * luma_[i]; });
  for (std::size_t i = 0; i < variance_.size(); ++i)
    variance_[i] -= mean_[i] * mean_[i];
}

std::vector<double> SsimReference::map(const Image& test) const {
  assert(test.width == width_ && test.height == height_);
  constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;
  const std::vector<double> y = luma(test, display_encoded_);
  const std::vector<double> mean = window_means(width_, height_, [&](std::size_t i) { return y[i]; });
  const std::vector<double> square = window_means(width_, height_, [&](std::size_t i) { return y[i] * y[i]; });
  std::vector<double> out = window_means(width_, height_, [&](std::size_t i) { return luma_[i] * y[i]; });
  // SSIM(x, y) = (2 mu_x mu_y + C1)(2 sigma_xy + C2) / ((mu_x^2 + mu_y^2 + C1)(sigma_x^2 + sigma_y^2 + C2)), Eq. 13.
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double product = mean_[i] * mean[i];
    const double covariance = out[i] - product;
    const double variance = square[i] - mean[i] * mean[i];
    out[i] = (2 * product + kC1) * (2 * covariance + kC2) /
             ((mean_[i] * mean_[i] + mean[i] * mean[i] + kC1) * (variance_[i] + variance + kC2));
  }
  return out;
}

}  // namespace pellucid::sweeps
