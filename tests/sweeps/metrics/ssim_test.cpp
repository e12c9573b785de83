#include "sweeps/metrics/ssim.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "gl/error.hpp"
#include "tests/sweeps/metrics/pictures.hpp"

namespace pellucid::sweeps {
namespace {

using testing::Color;
using testing::flat;
using testing::picture;
using testing::waves;

double luma(const Image& image, int x, int y) {
  const float* p = image.at(x, y);
  return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
}

/// Eq. 13 of Wang et al. 2004 for the window whose first pixel is (x0, y0): central moments, straight from their
/// definition.
double slow_ssim(const Image& a, const Image& b, int x0, int y0) {
  double weights = 0, mean_a = 0, mean_b = 0, var_a = 0, var_b = 0, covariance = 0;
  const auto weight = [](int i, int j) { return std::exp(-((i - 5) * (i - 5) + (j - 5) * (j - 5)) / 4.5); };
  for (int j = 0; j < 11; ++j) {
    for (int i = 0; i < 11; ++i) {
      weights += weight(i, j);
      mean_a += weight(i, j) * luma(a, x0 + i, y0 + j);
      mean_b += weight(i, j) * luma(b, x0 + i, y0 + j);
    }
  }
  mean_a /= weights;
  mean_b /= weights;
  for (int j = 0; j < 11; ++j) {
    for (int i = 0; i < 11; ++i) {
      const double w = weight(i, j) / weights;
      const double da = luma(a, x0 + i, y0 + j) - mean_a, db = luma(b, x0 + i, y0 + j) - mean_b;
      var_a += w * da * da;
      var_b += w * db * db;
      covariance += w * da * db;
    }
  }
  const double c1 = 0.0001, c2 = 0.0009;
  return (2 * mean_a * mean_b + c1) * (2 * covariance + c2) /
         ((mean_a * mean_a + mean_b * mean_b + c1) * (var_a + var_b + c2));
}

double only(const std::vector<double>& map) {
  EXPECT_EQ(map.size(), 1U);
  return map.front();
}

TEST(Ssim, FlatImagesCompareByTheirMeansAlone) {
  const SsimReference reference(flat(11, 11, {0.5, 0.5, 0.5}), true);
  EXPECT_NEAR(only(reference.map(flat(11, 11, {0.6, 0.6, 0.6}))), 0.6001 / 0.6101, 1e-6);
  EXPECT_NEAR(only(reference.map(flat(11, 11, {0.5, 0.5, 0.5}))), 1, 1e-12);
}

// x = 1 and its mirror 1 - x over one window with the centre lit: w = 0.0707622 is the centre's weight, so that
// mu_x = w, mu_y = 1 - w, both variances are w (1 - w) and the covariance is its negative.
TEST(Ssim, ALitPixelAgainstItsNegativeByHand) {
  const auto lit = [](bool negative) {
    return picture(11, 11, [negative](int x, int y) {
      const double v = (x == 5 && y == 5) != negative ? 1 : 0;
      return Color{v, v, v};
    });
  };
  double side = 0;
  for (int k = -5; k <= 5; ++k)
    side += std::exp(-k * k / 4.5);
  const double w = 1 / (side * side), v = w * (1 - w);
  EXPECT_NEAR(w, 0.0707622, 1e-6);
  EXPECT_NEAR(only(SsimReference(lit(false), true).map(lit(true))),
              (2 * v + 1e-4) * (-2 * v + 9e-4) / ((w * w + (1 - w) * (1 - w) + 1e-4) * (2 * v + 9e-4)), 1e-6);
}

TEST(Ssim, EveryWindowAgreesWithTheDefinition) {
  const auto [a, b] = waves(23, 17, false);
  const SsimReference reference(a, true);
  const std::vector<double> map = reference.map(b);
  ASSERT_EQ(reference.map_width(), 13);
  ASSERT_EQ(reference.map_height(), 7);
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 13; ++x)
      EXPECT_NEAR(map[static_cast<std::size_t>(y * 13 + x)], slow_ssim(a, b, x, y), 1e-9) << x << ", " << y;
}

TEST(Ssim, RadianceIsClampedAndEncodedFirst) {
  // 0.214041 and 0.318547 are sRGB 0.5 and 0.6.
  const SsimReference reference(flat(11, 11, {0.214041, 0.214041, 0.214041}), false);
  EXPECT_NEAR(only(reference.map(flat(11, 11, {0.318547, 0.318547, 0.318547}))), 0.6001 / 0.6101, 1e-5);
  EXPECT_NEAR(only(SsimReference(flat(11, 11, {5, 5, 5}), false).map(flat(11, 11, {9, 9, 9}))), 1, 1e-12);
}

TEST(Ssim, AFrameSmallerThanTheWindowIsAnError) {
  EXPECT_THROW(SsimReference(flat(10, 40, {1, 1, 1}), true), InputError);
  EXPECT_THROW(SsimReference(flat(40, 10, {1, 1, 1}), true), InputError);
}

}  // namespace
}  // namespace pellucid::sweeps
