#include "sweeps/measure/stopping.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace pellucid::sweeps {
namespace {

TimingLimits limits() {
  TimingLimits l;
  l.min_samples = 30;
  l.max_samples = 2000;
  l.max_seconds = 1e9;
  l.relative_ci = 0.005;
  return l;
}

/// Feeds samples until the verdict; elapsed time is the samples' sum.
template <class Draw>
Verdict feed(StoppingRule& rule, Draw&& draw) {
  double elapsed_s = 0;
  while (rule.verdict() == Verdict::more) {
    const double ms = draw();
    elapsed_s += ms / 1000;
    rule.add(ms, elapsed_s);
  }
  return rule.verdict();
}

TEST(Quantile, InterpolatesBetweenOrderStatistics) {
  const std::vector<double> sorted{1, 2, 4, 8};
  EXPECT_EQ(quantile(sorted, 0), 1);
  EXPECT_EQ(quantile(sorted, 1), 8);
  EXPECT_EQ(quantile(sorted, 0.5), 3);
  EXPECT_EQ(quantile(sorted, 0.25), 1.75);
  EXPECT_EQ(quantile(std::vector<double>{5}, 0.7), 5);
}

TEST(BootstrapInterval, OfThreeSamplesByHand) {
  // The median of three draws is the smallest sample when two or three of them hit it: 3 (1/3)² (2/3) + (1/3)³ = 7/27.
  const std::vector<double> sorted{1, 2, 3};
  const Interval wide = bootstrap_median_interval(sorted, 1 - 2 * 0.25);    // 0.25 < 7/27
  const Interval narrow = bootstrap_median_interval(sorted, 1 - 2 * 0.27);  // 0.27 > 7/27
  EXPECT_EQ(wide.low, 1);
  EXPECT_EQ(wide.high, 3);
  EXPECT_EQ(narrow.low, 2);
  EXPECT_EQ(narrow.high, 2);
}

TEST(BootstrapInterval, IsTheLimitOfManyResamples) {
  std::mt19937_64 random(7);
  std::lognormal_distribution<double> draw(0, 0.5);
  std::vector<double> samples(41);
  for (double& s : samples)
    s = draw(random);
  std::sort(samples.begin(), samples.end());
  std::vector<double> medians(40'000);
  std::vector<double> resample(samples.size());
  for (double& median : medians) {
    for (double& s : resample)
      s = samples[random() % samples.size()];
    std::nth_element(resample.begin(), resample.begin() + 20, resample.end());
    median = resample[20];
  }
  const Interval interval = bootstrap_median_interval(samples);
  const auto share = [&](auto&& predicate) {
    return static_cast<double>(std::count_if(medians.begin(), medians.end(), predicate)) /
           static_cast<double>(medians.size());
  };
  // 0.025 lies between the shares below and up to the low bound, and 0.975 at the high one; 0.003 is four deviations.
  EXPECT_LT(share([&](double m) { return m < interval.low; }), 0.025 + 0.003);
  EXPECT_GT(share([&](double m) { return m <= interval.low; }), 0.025 - 0.003);
  EXPECT_LT(share([&](double m) { return m < interval.high; }), 0.975 + 0.003);
  EXPECT_GT(share([&](double m) { return m <= interval.high; }), 0.975 - 0.003);
}

class Coverage : public testing::TestWithParam<std::size_t> {};

TEST_P(Coverage, OfTheTrueMedianIsNominal) {
  std::mt19937_64 random(11);
  std::exponential_distribution<double> draw(1.0);
  constexpr int kTrials = 3000;
  int covered = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> samples(GetParam());
    for (double& s : samples)
      s = draw(random);
    std::sort(samples.begin(), samples.end());
    const Interval i = bootstrap_median_interval(samples);
    covered += i.low <= std::log(2.0) && std::log(2.0) <= i.high ? 1 : 0;
  }
  const double coverage = static_cast<double>(covered) / kTrials;
  EXPECT_GT(coverage, 0.93);
  EXPECT_LT(coverage, 0.985);
}
INSTANTIATE_TEST_SUITE_P(Samples, Coverage, testing::Values(30, 51, 200));

TEST(StoppingRule, AConstantSeriesConvergesAtTheMinimum) {
  StoppingRule rule(limits());
  EXPECT_EQ(feed(rule, [] { return 12.5; }), Verdict::converged);
  EXPECT_EQ(rule.samples_ms().size(), 30U);
  const TimingSummary summary = summarise(rule.samples_ms());
  EXPECT_EQ(summary.median_ms, 12.5);
  EXPECT_EQ(summary.ci95_ms.low, 12.5);
  EXPECT_EQ(summary.ci95_ms.high, 12.5);
}

// Every fifth frame draws maps again: the median is that of the others, the mean shares the cost.
TEST(TimingSummary, MeanSharesWhatTheMedianMisses) {
  const std::vector<double> frames{10, 10, 60, 10, 10, 10, 10, 60, 10, 10};
  EXPECT_EQ(summarise(frames).median_ms, 10);
  EXPECT_DOUBLE_EQ(summarise(frames).mean_ms, 20);
}

TEST(StoppingRule, AZeroSeriesConvergesAndMakesNoNaN) {
  StoppingRule rule(limits());
  EXPECT_EQ(feed(rule, [] { return 0.0; }), Verdict::converged);
  EXPECT_EQ(summarise(rule.samples_ms()).median_ms, 0);
}

TEST(StoppingRule, MoreNoiseTakesMoreSamples) {
  const auto samples_needed = [](double deviation) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> draw(20, deviation);
    StoppingRule rule(limits());
    EXPECT_EQ(feed(rule, [&] { return std::max(0.0, draw(random)); }), Verdict::converged);
    const TimingSummary s = summarise(rule.samples_ms());
    EXPECT_LE((s.ci95_ms.high - s.ci95_ms.low) / 2, 0.005 * s.median_ms);
    EXPECT_NEAR(s.median_ms, 20, 0.2);
    return rule.samples_ms().size();
  };
  const std::size_t quiet = samples_needed(0.1);
  const std::size_t loud = samples_needed(1.0);
  EXPECT_EQ(quiet, 30U);
  EXPECT_GT(loud, 200U);  // (1.96 · 1.25 · 1 / 0.1)² = 600 expected
  EXPECT_LT(loud, 2000U);
}

TEST(StoppingRule, ABimodalSeriesDoesNotConvergeByLuck) {
  std::mt19937_64 random(5);
  TimingLimits l = limits();
  l.max_samples = 400;
  StoppingRule rule(l);
  EXPECT_EQ(feed(rule, [&] { return random() % 2 == 0 ? 10.0 : 20.0; }), Verdict::unconverged);
  EXPECT_EQ(rule.samples_ms().size(), 400U);
  const TimingSummary s = summarise(rule.samples_ms());
  EXPECT_EQ(s.ci95_ms.low, 10);
  EXPECT_EQ(s.ci95_ms.high, 20);
}

TEST(StoppingRule, TheTimeCapEndsItEvenBelowTheMinimum) {
  TimingLimits l = limits();
  l.max_seconds = 1;
  StoppingRule rule(l);
  EXPECT_EQ(feed(rule, [] { return 125.0; }), Verdict::unconverged);
  EXPECT_EQ(rule.samples_ms().size(), 8U);
  EXPECT_TRUE(std::isfinite(summarise(rule.samples_ms()).ci95_ms.high));
}

TEST(StoppingRule, ConvergingAtTheCapIsConverging) {
  TimingLimits l = limits();
  l.max_samples = 30;
  StoppingRule rule(l);
  EXPECT_EQ(feed(rule, [] { return 1.0; }), Verdict::converged);
}

// One sample has no spread that could be judged, whatever its limits say.
TEST(StoppingRule, OneSampleNeverConverges) {
  TimingLimits l = limits();
  l.min_samples = 1;
  l.max_samples = 1;
  StoppingRule one(l);
  EXPECT_EQ(feed(one, [] { return 1.0; }), Verdict::unconverged);
  EXPECT_EQ(one.samples_ms().size(), 1U);
  l.max_samples = 100;
  StoppingRule more(l);
  EXPECT_EQ(feed(more, [] { return 1.0; }), Verdict::converged);
  EXPECT_GE(more.samples_ms().size(), 2U);
}

/// The rule as its definition reads, sorting everything at each check.
Verdict slow_rule(const std::vector<double>& series, const TimingLimits& limits, std::size_t& used) {
  std::size_t next_check = 0;
  std::vector<double> samples;
  for (used = 1; used <= series.size(); ++used) {
    samples.push_back(series[used - 1]);
    const bool capped = used >= static_cast<std::size_t>(limits.max_samples);
    if (used >= static_cast<std::size_t>(limits.min_samples) && (used >= next_check || capped)) {
      const TimingSummary summary = summarise(samples);
      const double half_width = (summary.ci95_ms.high - summary.ci95_ms.low) / 2;
      if (used > 1 && half_width <= limits.relative_ci * summary.median_ms) return Verdict::converged;
      next_check = used + std::max<std::size_t>(5, used / 10);
    }
    if (capped) return Verdict::unconverged;
  }
  return Verdict::more;
}

TEST(StoppingRule, StopsWhereTheDefinitionDoes) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> noise(0, 0.05 * (seed % 8));
    std::vector<double> series(3000);
    for (double& ms : series)
      ms = 10 + std::abs(noise(random)) + (random() % 10 == 0 ? 1.0 : 0.0);
    TimingLimits l = limits();
    l.min_samples = 1 + static_cast<int>(seed);
    l.max_samples = 3000;
    std::size_t used = 0;
    const Verdict expected = slow_rule(series, l, used);
    StoppingRule rule(l);
    std::size_t i = 0;
    EXPECT_EQ(feed(rule, [&] { return series[i++]; }), expected) << seed;
    EXPECT_EQ(rule.samples_ms().size(), used) << seed;
  }
}

// The ranks do not depend on what was asked before, and are those of a search over all n.
TEST(MedianIntervalRanks, AreTheSameHoweverTheyAreReached) {
  MedianIntervalRanks growing;
  for (std::size_t n = 1; n < 400; ++n) {
    const auto a = growing.at(n);
    const auto b = MedianIntervalRanks().at(n);
    EXPECT_EQ(a.low, b.low);
    EXPECT_EQ(a.high, b.high);
    EXPECT_LE(a.low, (n + 1) / 2);
    EXPECT_GE(a.high, n / 2 + 1);
  }
}

TEST(StoppingRule, AHundredThousandSamplesCostLittle) {
  std::mt19937_64 random(9);
  TimingLimits l = limits();
  l.max_samples = 100'000;
  l.relative_ci = 1e-9;
  std::vector<double> series(100'000);
  for (double& ms : series)
    ms = 10 + static_cast<double>(random() % 1000) / 1000;
  StoppingRule rule(l);
  std::size_t i = 0;
  const std::clock_t start = std::clock();
  EXPECT_EQ(feed(rule, [&] { return series[i++]; }), Verdict::unconverged);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  EXPECT_LT(seconds, 2.0);  // 0.1 s measured, 0.8 s when each check sorted all; a sanitizer's build takes longer
  RecordProperty("seconds", std::to_string(seconds));
}

TEST(WarmUp, WaitsForTheRollingMedian) {
  WarmUp warm_up(64, 1e9);
  int frames = 0;
  for (const double ms : {100.0, 80.0, 60.0, 40.0, 30.0, 20.0, 10.0, 10.0, 10.0, 10.0, 10.0, 10.0, 10.0}) {
    if (warm_up.done()) break;
    warm_up.add(ms);
    ++frames;
  }
  EXPECT_TRUE(warm_up.settled());
  EXPECT_EQ(frames, 11);  // medians of frames 6-8 and 9-11 are 10 and 10
}

TEST(WarmUp, OneSlowFrameDoesNotUnsettle) {
  WarmUp warm_up(64, 1e9);
  for (const double ms : {10.0, 50.0, 10.0, 10.0, 10.0, 10.0})
    warm_up.add(ms);
  EXPECT_TRUE(warm_up.settled());
}

TEST(WarmUp, EndsAtItsCaps) {
  WarmUp frames(8, 1e9);
  WarmUp seconds(1000, 0.5);
  double ms = 1;
  while (!frames.done())
    frames.add(ms *= 2);
  EXPECT_EQ(frames.frames(), 8U);
  EXPECT_FALSE(frames.settled());
  ms = 100;
  while (!seconds.done())
    seconds.add(ms *= 2);
  EXPECT_EQ(seconds.frames(), 2U);
}

}  // namespace
}  // namespace pellucid::sweeps
