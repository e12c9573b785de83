#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <tbb/parallel_for.h>

#include "gl/error.hpp"
#include "sweeps/metrics/metrics.hpp"
#include "tests/input_error.hpp"
#include "tests/sweeps/metrics/pictures.hpp"

namespace pellucid::sweeps {
namespace {

using testing::flat;
using testing::waves;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

ComparisonOptions options(const std::vector<std::string>& metrics, bool display_encoded = false) {
  return {.metrics = MetricSet(metrics), .display_encoded = display_encoded};
}

double value(const Image& reference, const Image& test, const std::string& metric, bool display_encoded = false) {
  return Comparison(reference, nullptr, options({metric}, display_encoded)).compare(test).at(metric);
}

void expect_parts(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
}

TEST(Metrics, PixelErrorsByHand) {
  // Two pixels; of the six components one is off by 0.2 (0.5 to 0.7) and one by 0.3 (1 to 0.7).
  Image reference = flat(2, 1, {0.5, 0, 1}), test = reference;
  test.at(0, 0)[0] = 0.7F;
  test.at(1, 0)[2] = 0.7F;
  EXPECT_NEAR(value(reference, test, "mse"), (0.04 + 0.09) / 6, 1e-7);
  EXPECT_NEAR(value(reference, test, "rmse"), std::sqrt(0.13 / 6), 1e-7);
  EXPECT_NEAR(value(reference, test, "mae"), 0.5 / 6, 1e-7);
  EXPECT_NEAR(value(reference, test, "relmse"), (0.04 / 0.26 + 0.09 / 1.01) / 6, 1e-7);
  EXPECT_NEAR(value(reference, test, "smape"), (0.2 / 1.21 + 0.3 / 1.71) / 6, 1e-7);
}

TEST(Metrics, TheSignOfAnErrorDoesNotMatterButTheReferenceDoes) {
  const Image low = flat(3, 3, {0.2, 0.2, 0.2}), high = flat(3, 3, {0.4, 0.4, 0.4});
  for (const char* metric : {"mse", "mae", "smape"})
    EXPECT_EQ(value(low, high, metric), value(high, low, metric)) << metric;
  EXPECT_NEAR(value(low, high, "relmse"), 0.04 / 0.05, 1e-6);
  EXPECT_NEAR(value(high, low, "relmse"), 0.04 / 0.17, 1e-6);
}

TEST(Metrics, PsnrStatesItsPeak) {
  const Image reference = flat(4, 4, {0.5, 0.5, 0.5}), test = flat(4, 4, {0.6, 0.6, 0.6});
  EXPECT_NEAR(value(reference, test, "psnr", true), 20, 1e-4);  // peak 1, mse 0.01
  Image bright = reference, bright_test = test;
  bright.at(2, 1)[1] = bright_test.at(2, 1)[1] = 4;  // peak 4; 47 of 48 components are off by 0.1
  EXPECT_NEAR(value(bright, bright_test, "psnr"), 10 * std::log10(16 / (0.01 * 47 / 48)), 1e-4);
  EXPECT_NEAR(value(flat(4, 4, {0, 0, 0}), flat(4, 4, {0.1, 0.1, 0.1}), "psnr"), 20, 1e-4);  // a black reference
}

TEST(Metrics, IdenticalImagesHaveNoError) {
  for (const bool encoded : {false, true}) {
    const Image image = waves(40, 30, !encoded).reference;
    const ComparisonResult result = Comparison(image, nullptr, options(metric_names(), encoded)).compare(image);
    for (const auto& [name, v] : result.values) {
      if (name == "psnr")
        EXPECT_EQ(v, kInfinity);
      else if (name == "ssim")
        EXPECT_NEAR(v, 1, 1e-12);
      else
        EXPECT_EQ(v, 0) << name;
    }
  }
}

TEST(Metrics, AnInfinitePsnrIsNullInJson) {
  const Image image = waves(20, 20, false).reference;
  nlohmann::json row = {{"technique", "none"}};
  put_values(row, Comparison(image, nullptr, options({"psnr", "mse"})).compare(image));
  EXPECT_EQ(row.dump(), R"({"mse":0.0,"psnr":null,"technique":"none"})");
}

TEST(Metrics, TheSetKeepsItsOrderAndKnowsItsNames) {
  EXPECT_EQ(MetricSet(std::vector<std::string>{"ssim", "mse", "flip", "mse"}).names(),
            (std::vector<std::string>{"flip", "mse", "ssim"}));
  EXPECT_EQ(MetricSet().names(), metric_names());
  EXPECT_TRUE(MetricSet().has("smape"));
  EXPECT_FALSE(MetricSet(std::vector<std::string>{"mse"}).has("flip"));
  expect_parts(pellucid::test::input_error([] { MetricSet(std::vector<std::string>{"rmsee"}); }),
               {"'rmsee'", "did you mean 'rmse'"});
  expect_parts(pellucid::test::input_error([] { MetricSet(std::vector<std::string>{"colourfulness"}); }),
               {"flip, mse", "ssim"});
  EXPECT_THROW(MetricSet(std::vector<std::string>{}), InputError);
}

TEST(Metrics, ColumnsAreTheNamesOfTheValues) {
  const auto [reference, test] = waves(24, 24, true);
  const Image mask(flat(24, 24, {1, 1, 1}));
  for (const bool masked : {false, true}) {
    const ComparisonResult result = Comparison(reference, masked ? &mask : nullptr).compare(test);
    std::vector<std::string> names;
    for (const auto& [name, v] : result.values) {
      names.push_back(name);
      EXPECT_TRUE(std::isfinite(v)) << name;
    }
    EXPECT_EQ(names, MetricSet().columns(masked));
  }
  const std::vector<std::string> columns = MetricSet(std::vector<std::string>{"flip", "psnr"}).columns(true);
  EXPECT_EQ(columns, (std::vector<std::string>{
                         "flip_mean", "flip_weighted_median", "flip_weighted_q1", "flip_weighted_q3", "flip_min",
                         "flip_max", "psnr", "flip_mean_mask", "flip_weighted_median_mask", "flip_weighted_q1_mask",
                         "flip_weighted_q3_mask", "flip_min_mask", "flip_max_mask", "psnr_mask"}));
  EXPECT_THROW(Comparison(reference, nullptr, options({"mse"})).compare(test).at("ssim"), std::out_of_range);
}

// ---- mask ----

TEST(Mask, RestrictsTheStatisticsNotTheMaps) {
  const auto [reference, test] = waves(40, 30, true);
  Image mask(40, 30, 1);
  for (int y = 5; y < 20; ++y)
    for (int x = 10; x < 33; ++x)
      *mask.at(x, y) = 1;
  *mask.at(0, 0) = 0.5F;  // not above a half
  ComparisonOptions all;
  all.keep_map = true;
  const ComparisonResult result = Comparison(reference, &mask, all).compare(test);
  double squared = 0, flip = 0, flip_max = 0;
  for (int y = 5; y < 20; ++y) {
    for (int x = 10; x < 33; ++x) {
      for (int c = 0; c < 3; ++c)
        squared += std::pow(double{test.at(x, y)[c]} - double{reference.at(x, y)[c]}, 2);
      flip += *result.flip_map.at(x, y);
      flip_max = std::max(flip_max, double{*result.flip_map.at(x, y)});
    }
  }
  EXPECT_NEAR(result.at("mse_mask") / (squared / (3 * 15 * 23)), 1, 1e-9);
  EXPECT_NEAR(result.at("flip_mean_mask"), flip / (15 * 23), 1e-9);
  EXPECT_EQ(result.at("flip_max_mask"), flip_max);
  EXPECT_NE(result.at("flip_mean_mask"), result.at("flip_mean"));
  // The whole frame's values do not know the mask.
  const ComparisonResult bare = Comparison(reference, nullptr, all).compare(test);
  EXPECT_EQ(bare.flip_map.pixels, result.flip_map.pixels);
  for (const auto& [name, v] : bare.values)
    EXPECT_EQ(v, result.at(name)) << name;
}

TEST(Mask, OfTheWholeFrameChangesNothing) {
  const auto [reference, test] = waves(30, 30, false);
  const Image everything = flat(30, 30, {1, 1, 1});
  const Comparison comparison(reference, &everything, options(metric_names(), true));
  EXPECT_TRUE(comparison.masked());
  const ComparisonResult result = comparison.compare(test);
  for (const std::string& column : MetricSet().columns(false))
    EXPECT_DOUBLE_EQ(result.at(column), result.at(column + "_mask")) << column;
}

TEST(Mask, SsimIsTakenWhereTheWindowsCentreIsMarked) {
  // The images differ only on the right, more than a window away from the marked left.
  const Image reference = waves(48, 16, false).reference;
  Image test = reference, mask(48, 16, 1);
  for (int y = 0; y < 16; ++y)
    test.at(40, y)[1] = 0;
  *mask.at(8, 8) = 1;
  const ComparisonResult result = Comparison(reference, &mask, options({"ssim"}, true)).compare(test);
  EXPECT_NEAR(result.at("ssim_mask"), 1, 1e-12);
  EXPECT_LT(result.at("ssim"), 0.99);
}

TEST(Mask, ThatCannotBeUsedIsAnError) {
  const Image reference = waves(30, 20, true).reference;
  const auto with = [&](const Image& mask) {
    return pellucid::test::input_error([&] { Comparison(reference, &mask, options({"mse", "ssim"})); });
  };
  expect_parts(with(Image(30, 20, 1)), {"mask", "no pixel"});
  expect_parts(with(flat(20, 30, {1, 1, 1})), {"mask", "20x30", "30x20"});
  Image nan = flat(30, 20, {1, 1, 1});
  nan.at(4, 6)[0] = std::nanf("");
  expect_parts(with(nan), {"mask", "(4, 6)"});
  Image border(30, 20, 1);
  *border.at(2, 2) = 1;
  expect_parts(with(border), {"mask", "ssim"});
}

// ---- what cannot be compared ----

TEST(Comparison, NamesTheFirstPixelThatIsNotFinite) {
  const Image sound = waves(20, 20, true).reference;
  Image nan = sound, infinite = sound;
  nan.at(3, 2)[1] = std::nanf("");
  nan.at(1, 9)[0] = std::nanf("");
  infinite.at(19, 19)[2] = -std::numeric_limits<float>::infinity();
  for (const std::string& metric : metric_names()) {
    const Comparison comparison(sound, nullptr, options({metric}));
    expect_parts(pellucid::test::input_error([&] { comparison.compare(nan); }), {"test", "channel G", "(3, 2)", "nan"});
    expect_parts(pellucid::test::input_error([&] { comparison.compare(infinite); }),
                 {"test", "channel B", "(19, 19)", "inf"});
    expect_parts(pellucid::test::input_error([&] { Comparison(nan, nullptr, options({metric})); }),
                 {"reference", "(3, 2)"});
  }
  Image alpha(2, 2, 4);
  alpha.at(1, 0)[3] = std::nanf("");
  Comparison(alpha, nullptr, options({"mse"}));  // alpha is not compared
}

TEST(Comparison, RefusesOtherSizesAndChannels) {
  const Comparison comparison(waves(20, 12, true).reference, nullptr, options({"mse"}));
  expect_parts(pellucid::test::input_error([&] { comparison.compare(waves(12, 20, true).test); }), {"12x20", "20x12"});
  expect_parts(pellucid::test::input_error([&] { comparison.compare(Image(20, 12, 2)); }), {"2 channels"});
  EXPECT_THROW(Comparison(Image(), nullptr, options({"mse"})), InputError);
  EXPECT_THROW(Comparison(Image(0, 4, 3), nullptr, options({"mse"})), InputError);
  expect_parts(pellucid::test::input_error([] {
                 Comparison(Image(8, 8, 3), nullptr, options({"mse", "ssim"}));
               }),
               {"ssim", "11x11", "8x8"});
  ComparisonOptions exposed = options({"flip"}, true);
  exposed.exposures = Exposures{0, 1, 2};
  EXPECT_THROW(Comparison(Image(8, 8, 3), nullptr, exposed), InputError);
}

TEST(Comparison, GreyStandsForThreeChannelsAndAlphaForNone) {
  const auto [reference, test] = waves(20, 20, true);
  Image grey(20, 20, 1), expanded(20, 20, 3), with_alpha(20, 20, 4);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      *grey.at(x, y) = test.at(x, y)[0];
      std::fill_n(expanded.at(x, y), 3, test.at(x, y)[0]);
      std::copy_n(test.at(x, y), 3, with_alpha.at(x, y));
      with_alpha.at(x, y)[3] = 17;
    }
  }
  const Comparison comparison(reference);
  EXPECT_EQ(comparison.compare(grey).values, comparison.compare(expanded).values);
  EXPECT_EQ(comparison.compare(with_alpha).values, comparison.compare(test).values);
}

TEST(Comparison, ExposuresBelongToTheReference) {
  const auto [reference, test] = waves(30, 20, true);
  const Comparison comparison(reference, nullptr, options({"flip"}));
  ASSERT_NE(comparison.exposures(), nullptr);
  EXPECT_EQ(*comparison.exposures(), automatic_exposures(reference));
  ComparisonOptions fixed = options({"flip"});
  fixed.exposures = Exposures{-1, 1, 2};
  const Comparison other(reference, nullptr, fixed);
  EXPECT_EQ(*other.exposures(), (Exposures{-1, 1, 2}));
  EXPECT_NE(comparison.compare(test).at("flip_mean"), other.compare(test).at("flip_mean"));
  EXPECT_EQ(Comparison(reference, nullptr, options({"mse"})).exposures(), nullptr);
  EXPECT_EQ(Comparison(test, nullptr, options({"flip"}, true)).exposures(), nullptr);
}

TEST(Comparison, IsTheSameFromSeveralThreads) {
  const auto [reference, test] = waves(64, 48, true);
  const Comparison comparison(reference);
  const auto expected = comparison.compare(test).values;
  std::vector<ComparisonResult> results(6);
  tbb::parallel_for(std::size_t{0}, results.size(),
                    [&, &test = test](std::size_t i) { results[i] = comparison.compare(test); });
  for (const ComparisonResult& result : results)
    EXPECT_EQ(result.values, expected);
}

}  // namespace
}  // namespace pellucid::sweeps
