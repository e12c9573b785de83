#include "sweeps/metrics/flip.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "gl/error.hpp"
#include "tests/sweeps/metrics/pictures.hpp"
#include "tests/sweeps/metrics/slow_flip.hpp"

namespace pellucid::sweeps {
namespace {

using testing::flat;
using testing::mean;
using testing::picture;
using testing::slow_hdr_flip;
using testing::slow_ldr_flip;
using testing::waves;

std::vector<float> ldr(const Image& reference, const Image& test, double ppd = kDefaultPixelsPerDegree) {
  return FlipReference::display_encoded(reference, {.pixels_per_degree = ppd}).map(test).pixels;
}

std::vector<float> hdr(const Image& reference, const Image& test) {
  return FlipReference::scene_linear(reference, automatic_exposures(reference)).map(test).pixels;
}

void expect_same(const std::vector<float>& errors, const std::vector<double>& expected, double tolerance) {
  ASSERT_EQ(errors.size(), expected.size());
  double worst = 0;
  for (std::size_t i = 0; i < errors.size(); ++i)
    worst = std::max(worst, std::abs(errors[i] - expected[i]));
  EXPECT_LT(worst, tolerance);
}

// White is 100 units of L* from black, colourless; 100^0.7 = 25.1189. Green is 128.24 from blue, c_max = 41.276 (HyAB
// of the two in Hunt-adjusted L*a*b*, raised to 0.7), so the error is 0.95 + (25.1189 - 0.4 c_max) / (0.6 c_max) 0.05.
TEST(Flip, FlatImagesHaveAClosedForm) {
  constexpr double kLargest = 41.2760;
  EXPECT_NEAR(ldr(flat(5, 4, {1, 1, 1}), flat(5, 4, {0, 0, 0}))[7],
              0.95 + (std::pow(100, 0.7) - 0.4 * kLargest) / (0.6 * kLargest) * 0.05, 1e-5);
  EXPECT_NEAR(ldr(flat(5, 4, {0, 1, 0}), flat(5, 4, {0, 0, 1}))[0], 1, 1e-5);
  // sRGB 0.5 is 0.214041 linear and L* 53.3890; 0.25 is 0.0508761 and L* 26.9829. Below the knee, 0.95 d^0.7 / (0.4
  // c_max).
  EXPECT_NEAR(ldr(flat(5, 4, {0.5, 0.5, 0.5}), flat(5, 4, {0.25, 0.25, 0.25}))[19],
              0.95 * std::pow(53.38896 - 26.98292, 0.7) / (0.4 * kLargest), 1e-5);
}

// Values of the published formulation (the PyTorch code of version 1.6 of the tool, carried to double precision) for
// the same pictures; the sample images of its own tests are not part of this tree.
TEST(Flip, AgreesWithThePublishedFormulation) {
  EXPECT_NEAR(ldr(flat(4, 4, {1, 1, 1}), flat(4, 4, {0, 0, 0}))[0], 0.967379763, 1e-6);
  EXPECT_NEAR(ldr(flat(4, 4, {1, 0, 0}), flat(4, 4, {0, 1, 0}))[0], 0.986662275, 1e-6);
  EXPECT_NEAR(ldr(flat(4, 4, {0.2, 0.4, 0.6}), flat(4, 4, {0.25, 0.35, 0.7}))[0], 0.325954193, 1e-6);
  const auto [reference, test] = waves(96, 64, false);
  const std::vector<float> errors = ldr(reference, test);
  EXPECT_NEAR(mean(errors), 0.386879078, 1e-6);
  EXPECT_NEAR(*std::max_element(errors.begin(), errors.end()), 0.738124417, 2e-6);
  EXPECT_NEAR(*std::min_element(errors.begin(), errors.end()), 0.070656570, 2e-6);
  EXPECT_NEAR(mean(ldr(reference, test, 30)), 0.388768313, 1e-6);

  const auto [bright_reference, bright_test] = waves(96, 64, true);
  const Exposures exposures = automatic_exposures(bright_reference);
  EXPECT_NEAR(exposures.start, -1.847559688, 1e-6);
  EXPECT_NEAR(exposures.stop, 1.363276445, 1e-6);
  EXPECT_EQ(exposures.count, 4);
  EXPECT_NEAR(mean(hdr(bright_reference, bright_test)), 0.488209121, 1e-6);
}

TEST(Flip, LdrAgreesWithTheSlowTwinEverywhere) {
  for (const double ppd : {kDefaultPixelsPerDegree, 20.0, 1.0}) {
    const auto [reference, test] = waves(37, 26, false);
    expect_same(ldr(reference, test, ppd), slow_ldr_flip(reference, test, ppd), 2e-5);
  }
}

TEST(Flip, HdrAgreesWithTheSlowTwinEverywhere) {
  const auto [reference, test] = waves(37, 26, true);
  const Exposures exposures{-3, 2, 4};
  const Image map = FlipReference::scene_linear(reference, exposures).map(test);
  const std::vector<double> stops{-3, -3 + 5.0 / 3, -3 + 10.0 / 3, 2};
  expect_same(map.pixels, slow_hdr_flip(reference, test, kDefaultPixelsPerDegree, stops), 2e-5);
}

// One pixel of other colour: the error spreads as the filters do, and is largest near it.
TEST(Flip, ASinglePixelAgreesWithTheSlowTwin) {
  const Image reference = flat(41, 35, {0.4, 0.5, 0.6});
  Image test = reference;
  test.at(20, 17)[0] = 1;
  test.at(20, 17)[2] = 0;
  const std::vector<float> errors = ldr(reference, test);
  expect_same(errors, slow_ldr_flip(reference, test, kDefaultPixelsPerDegree), 2e-5);
  const auto at = [&](int x, int y) { return errors[static_cast<std::size_t>(y * 41 + x)]; };
  EXPECT_GT(at(20, 17), 0.01);
  EXPECT_EQ(at(9, 17), 0);  // eleven away, the widest filter's radius is ten
  EXPECT_GT(at(11, 17), 0);
  EXPECT_EQ(at(20, 5), 0);
}

TEST(Flip, SmallFramesAgreeWithTheSlowTwin) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{1, 9}, std::pair{17, 1}, std::pair{16, 2}}) {
    const auto [reference, test] = waves(width, height, false);
    expect_same(ldr(reference, test), slow_ldr_flip(reference, test, kDefaultPixelsPerDegree), 2e-5);
  }
}

TEST(Flip, IdenticalImagesHaveNoErrorAtAll) {
  for (const float e : ldr(waves(50, 40, false).reference, waves(50, 40, false).reference))
    EXPECT_EQ(e, 0);
  for (const float e : hdr(waves(50, 40, true).test, waves(50, 40, true).test))
    EXPECT_EQ(e, 0);
}

TEST(Flip, IsSymmetricAndInTheUnitInterval) {
  const auto [a, b] = waves(50, 40, false);
  EXPECT_EQ(ldr(a, b), ldr(b, a));
  const auto [c, d] = waves(50, 40, true);
  const Exposures exposures{-2, 3, 3};
  EXPECT_EQ(FlipReference::scene_linear(c, exposures).map(d).pixels,
            FlipReference::scene_linear(d, exposures).map(c).pixels);
  const auto noise = [](int seed) {
    return picture(40, 40, [seed](int x, int y) {
      const auto bit = [&](int i) { return ((x * 7919) ^ (y * 1949) ^ ((i + seed) * 8349)) >> 4 & 1; };
      return testing::Color{double(bit(0)), double(bit(1)), double(bit(2))};
    });
  };
  for (const float e : ldr(noise(1), noise(5))) {
    EXPECT_GE(e, 0);
    EXPECT_LE(e, 1);
  }
}

TEST(Flip, GrowsWithTheError) {
  const Image reference = flat(12, 12, {0.3, 0.3, 0.3});
  double previous = 0;
  for (const double step : {0.01, 0.05, 0.1, 0.3, 0.7}) {
    const double error = mean(ldr(reference, flat(12, 12, {0.3 + step, 0.3 + step, 0.3 + step})));
    EXPECT_GT(error, previous) << step;
    previous = error;
  }
}

TEST(Flip, ThePerExposureMaximumIsTaken) {
  const auto [reference, test] = waves(30, 30, true);
  Image largest(30, 30, 1);
  for (const double stops : {-4.0, 0.0, 4.0}) {
    const Image one = FlipReference::scene_linear(reference, {stops, stops, 1}).map(test);
    for (std::size_t i = 0; i < largest.pixels.size(); ++i)
      largest.pixels[i] = std::max(largest.pixels[i], one.pixels[i]);
  }
  EXPECT_EQ(FlipReference::scene_linear(reference, {-4, 4, 3}).map(test).pixels, largest.pixels);
}

TEST(Flip, WithoutRoomForTheReferenceTheMapIsTheSame) {
  const auto [reference, test] = waves(33, 20, true);
  const Exposures exposures{-3, 3, 5};
  EXPECT_EQ(FlipReference::scene_linear(reference, exposures).map(test).pixels,
            FlipReference::scene_linear(reference, exposures, {.largest_cache_bytes = 0}).map(test).pixels);
}

TEST(Flip, ExtremeRadianceStaysInTheUnitInterval) {
  Image reference = flat(15, 15, {0.01, 1, 0.2});
  reference.at(7, 7)[0] = std::numeric_limits<float>::max();
  reference.at(3, 3)[1] = -5;
  Image test = flat(15, 15, {0.02, 1, 0.2});
  test.at(4, 4)[2] = std::numeric_limits<float>::max();
  for (const float e : hdr(reference, test)) {
    EXPECT_GE(e, 0);
    EXPECT_LE(e, 1);
  }
  const float tiny = std::numeric_limits<float>::denorm_min();
  Image dark = flat(15, 15, {tiny, tiny, tiny});
  dark.at(0, 0)[0] = 0;
  const Exposures exposures = automatic_exposures(dark);
  EXPECT_GT(exposures.start, 149);
  for (const float e : FlipReference::scene_linear(dark, exposures).map(reference).pixels) {
    EXPECT_GE(e, 0);
    EXPECT_LE(e, 1);
  }
}

TEST(Flip, OptionsOutOfRangeAreErrors) {
  const Image image = flat(4, 4, {1, 1, 1});
  const auto with_ppd = [&](double ppd) { FlipReference::display_encoded(image, {.pixels_per_degree = ppd}); };
  EXPECT_THROW(with_ppd(0), InputError);
  EXPECT_THROW(with_ppd(-67), InputError);
  EXPECT_THROW(with_ppd(1e9), InputError);
  EXPECT_THROW(with_ppd(std::nan("")), InputError);
  const auto with = [&](const Exposures& e) { FlipReference::scene_linear(image, e); };
  EXPECT_THROW(with({1, 0, 2}), InputError);
  EXPECT_THROW(with({0, 1, 0}), InputError);
  EXPECT_THROW(with({0, std::numeric_limits<double>::infinity(), 2}), InputError);
  EXPECT_THROW(with({std::nan(""), 1, 2}), InputError);
  EXPECT_NO_THROW(with({1, 1, 1}));
}

// ---- exposures ----

/// The x at which the ACES curve reaches 0.85: 0.16002 x^2 - 0.2829 x - 0.119 = 0.
const double kReaches = (0.2829 + std::sqrt(0.2829 * 0.2829 + 4 * 0.16002 * 0.119)) / (2 * 0.16002);

Image greys(const std::vector<double>& values) {
  return picture(static_cast<int>(values.size()), 1, [&](int x, int) {
    const double v = values[static_cast<std::size_t>(x)];
    return testing::Color{v, v, v};
  });
}

TEST(AutomaticExposures, GoFromTheBrightestToTheMedian) {
  const Exposures even = automatic_exposures(greys({8, 1, 4, 2}));  // the upper median, 4
  EXPECT_NEAR(even.start, std::log2(kReaches / 8), 1e-6);
  EXPECT_NEAR(even.stop, std::log2(kReaches / 4), 1e-6);
  EXPECT_EQ(even.count, 2);
  const Exposures odd = automatic_exposures(greys({64, 0.5, 1, 0.25, 2}));
  EXPECT_NEAR(odd.start, std::log2(kReaches / 64), 1e-6);
  EXPECT_NEAR(odd.stop, std::log2(kReaches / 1), 1e-6);
  EXPECT_EQ(odd.count, 6);
  EXPECT_EQ(automatic_exposures(greys({65, 0.5, 1, 0.25, 2})).count, 7);
}

TEST(AutomaticExposures, UseLuminance) {
  const Exposures e = automatic_exposures(picture(1, 1, [](int, int) { return testing::Color{1, 2, 3}; }));
  EXPECT_NEAR(e.start, std::log2(kReaches / (0.2126 * 1 + 0.7152 * 2 + 0.0722 * 3)), 1e-6);
  EXPECT_EQ(e.start, e.stop);
  EXPECT_EQ(e.count, 2);
}

TEST(AutomaticExposures, BlackPixelsHaveNoExposure) {
  const Exposures mostly_black = automatic_exposures(greys({0, 0, 0, 0, 1, 16, 4}));
  EXPECT_NEAR(mostly_black.start, std::log2(kReaches / 16), 1e-6);
  EXPECT_NEAR(mostly_black.stop, std::log2(kReaches / 4), 1e-6);
  EXPECT_EQ(automatic_exposures(greys({0, -1, 0})), (Exposures{0, 0, 2}));
}

TEST(AutomaticExposures, AreEvenlySpaced) {
  const Exposures e{-2, 4, 4};
  EXPECT_EQ(e.at(0), -2);
  EXPECT_EQ(e.at(1), 0);
  EXPECT_EQ(e.at(3), 4);
  EXPECT_EQ((Exposures{3, 5, 1}.at(0)), 3);
}

// ---- pooling ----

TEST(Pooling, WeightsErrorsByThemselves) {
  // In order 0.25, 0.5, 0.75, 1, 1.5, with running sums 0.25, 0.75, 1.5, 2.5, 4: the first above 1, 2 and 3 count.
  const std::vector<float> errors{1.5F, 0.25F, 1, 0.5F, 0.75F};
  const FlipStatistics s = pool(errors);
  EXPECT_DOUBLE_EQ(s.mean, 0.8);
  EXPECT_DOUBLE_EQ(s.weighted_q1, 0.75);
  EXPECT_DOUBLE_EQ(s.weighted_median, 1);
  EXPECT_DOUBLE_EQ(s.weighted_q3, 1.5);
  EXPECT_DOUBLE_EQ(s.min, 0.25);
  EXPECT_DOUBLE_EQ(s.max, 1.5);
}

TEST(Pooling, APercentileMustBeExceeded) {
  const std::vector<float> errors{0.25F, 0.25F, 0.25F, 0.25F, 1};  // the sum is 2; up to the last 0.25 it is exactly 1
  EXPECT_DOUBLE_EQ(pool(errors).weighted_median, 1);
  EXPECT_DOUBLE_EQ(pool(errors).weighted_q1, 0.25);
}

TEST(Pooling, ZerosWeighNothing) {
  EXPECT_EQ(pool(std::vector<float>(9, 0.0F)).weighted_median, 0);
  EXPECT_EQ(pool(std::vector<float>(9, 0.0F)).weighted_q3, 0);
  EXPECT_EQ(pool(std::vector<float>{0, 0, 0, 0, 0, 0, 0.5F}).weighted_q1, 0.5);
  EXPECT_THROW(pool({}), InputError);
}

TEST(ErrorColors, GrowLighterEvenly) {
  Image ramp(101, 1, 1);
  for (int x = 0; x <= 100; ++x)
    *ramp.at(x, 0) = static_cast<float>(x) / 100;
  const Image colors = error_colors(ramp);
  ASSERT_EQ(colors.channels, 3);
  double previous = -1;
  for (int x = 0; x <= 100; ++x) {
    const auto linear = [&](int c) {
      const double v = colors.at(x, 0)[c];
      return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    };
    const double y = 0.2126 * linear(0) + 0.7152 * linear(1) + 0.0722 * linear(2);
    const double lightness = y > 216.0 / 24389 ? 116 * std::cbrt(y) - 16 : y * 24389.0 / 27;
    EXPECT_GT(lightness, previous);
    EXPECT_NEAR(lightness, 97.3 * x / 100, 3);
    previous = lightness;
  }
  EXPECT_THROW(error_colors(Image(2, 2, 3)), InputError);
}

}  // namespace
}  // namespace pellucid::sweeps
