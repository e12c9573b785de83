#include "sweeps/tune/compare_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sweeps/tune/median_interval.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;

/// Frame times as they come: skewed, with outliers, and each near the one before.
std::vector<double> frames(std::mt19937_64& random, double median_ms, std::size_t n, double together = 0.3) {
  std::normal_distribution<double> noise(0, 0.01);
  std::vector<double> samples;
  double slow = 0;
  for (std::size_t i = 0; i < n; ++i) {
    slow = together * slow + std::sqrt(1 - together * together) * noise(random);
    const double spike = random() % 50 == 0 ? 0.3 : 0;
    samples.push_back(median_ms * std::exp(slow + spike));
  }
  return samples;
}

json row(int n, const std::vector<double>& samples, double flip = 0.1) {
  std::vector<double> sorted = samples;
  std::sort(sorted.begin(), sorted.end());
  json result{{"status", "ok"}, {"technique", "t"}, {"scene", "s"},     {"view", "v"},
              {"width", 8},     {"height", 8},      {"n", n},           {"frame_ms_samples", samples},
              {"device", "d"},  {"driver", "v"},    {"flip_mean", flip}};
  if (!samples.empty()) result["frame_ms_median"] = quantile(sorted, 0.5);
  return result;
}

/// Two runs of `points` points; `factor` says how much longer each takes in the second.
RowComparison two_runs(
    std::size_t points, std::uint64_t seed, double between,
    const std::function<double(std::size_t)>& factor = [](std::size_t) { return 1.0; }, std::size_t samples = 30) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> shift(0, between);
  std::vector<json> a;
  std::vector<json> b;
  for (std::size_t i = 0; i < points; ++i) {
    const double ms = 1 + static_cast<double>(i % 17);
    const std::size_t n = samples + random() % 100;
    a.push_back(row(static_cast<int>(i), frames(random, ms * std::exp(shift(random)), n)));
    b.push_back(row(static_cast<int>(i), frames(random, ms * factor(i) * std::exp(shift(random)), n)));
  }
  return compare_rows(a, b, {"n"}, {}, {}, {});
}

TEST(MedianInterval, HoldsTheMedianAsOftenAsItSays) {
  std::mt19937_64 random(1);
  for (const double together : {0.0, 0.6}) {
    int misses = 0;
    for (int i = 0; i < 4000; ++i) {
      const auto range = median_interval(frames(random, 1.0, 60, together), 0.95);
      ASSERT_TRUE(range.has_value());
      // The spikes move the distribution's median by a hair.
      if (range->low > 1.0006 || range->high < 1.0) ++misses;
    }
    // 5 % are promised; the estimate of how far neighbours go together adds a little.
    EXPECT_LT(misses, 4000 * 0.07) << together;
    EXPECT_GT(misses, 4000 * 0.01) << together;
  }
}

TEST(MedianInterval, HasNothingToSayOfFewSamples) {
  EXPECT_FALSE(median_interval(std::vector<double>{1, 2, 3}, 0.95).has_value());
  EXPECT_FALSE(median_interval(std::vector<double>{}, 0.95).has_value());
  EXPECT_TRUE(median_interval(std::vector<double>{1, 2, 3, 4, 5, 6}, 0.95).has_value());  // 2 / 2^6 < 0.05
}

// The A/A test: of two runs of the same code at most alpha of the points may be called different. With the correction
// for their number hardly any is.
TEST(CompareRows, CallsTenThousandEqualPointsEqual) {
  for (const double between : {0.0, 0.01}) {
    const RowComparison result = two_runs(10'000, 7, between);
    ASSERT_EQ(result.points.size(), 10'000U);
    const std::size_t different = result.count(TimeChange::faster) + result.count(TimeChange::slower);
    EXPECT_LE(different, 10U) << between;  // 500 would be alpha
    EXPECT_EQ(result.count(QualityChange::same), 10'000U);
    EXPECT_EQ(result.regressions(), 0U);
  }
}

TEST(CompareRows, KeepsItsPromiseOverManyRunsOfFewPoints) {
  int runs_with_a_difference = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const RowComparison result = two_runs(10, 100 + seed, 0);
    runs_with_a_difference += result.count(TimeChange::faster) + result.count(TimeChange::slower) > 0 ? 1 : 0;
  }
  EXPECT_LE(runs_with_a_difference, 400 * 0.05 + 9);  // two standard deviations of chance
}

TEST(CompareRows, FindsWhatHasChanged) {
  const RowComparison result = two_runs(
      200, 3, 0.003, [](std::size_t i) { return i % 10 == 0   ? 1.1
                                                : i % 10 == 5 ? 0.9
                                                              : 1.0; }, 100);
  EXPECT_EQ(result.count(TimeChange::slower), 20U);
  EXPECT_EQ(result.count(TimeChange::faster), 20U);
  EXPECT_EQ(result.regressions(), 20U);
  EXPECT_NEAR(result.between_runs, 0.004, 0.004);
}

TEST(CompareRows, JudgesQualityByEveryMetric) {
  std::mt19937_64 random(2);
  const std::vector<double> samples = frames(random, 1, 30);
  const std::vector<json> a{row(1, samples, 0.1), row(2, samples, 0.1), row(3, {}, 0.1)};
  const std::vector<json> b{row(1, samples, 0.2), row(2, samples, 0.05), row(3, {}, 0.1)};
  const RowComparison result = compare_rows(a, b, {"n"}, {}, {}, {});
  ASSERT_EQ(result.points.size(), 3U);
  EXPECT_EQ(result.points[0].quality, QualityChange::worse);
  EXPECT_TRUE(result.points[0].regression);
  EXPECT_EQ(result.points[1].quality, QualityChange::better);
  EXPECT_EQ(result.points[2].quality, QualityChange::same);
  EXPECT_EQ(result.points[2].time, TimeChange::untimed);
  EXPECT_EQ(result.points[0].point, "t s v 8x8 n=1");
}

TEST(CompareRows, CountsWhatHasNoPartner) {
  const std::vector<json> a{row(1, {}), row(2, {})};
  std::vector<json> b{row(2, {}), row(3, {}), row(4, {})};
  b[2]["status"] = "failed";
  const RowComparison result = compare_rows(a, b, {"n"}, {}, {}, {});
  EXPECT_EQ(result.points.size(), 1U);
  EXPECT_EQ(result.only_in_a, 1U);
  EXPECT_EQ(result.only_in_b, 1U);
}

}  // namespace
}  // namespace pellucid::sweeps
