#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sweeps/spec/spec.hpp"

/// Statistics of frame times, and the rules that end warming up and sampling. No clock, no GL: samples go in.
namespace pellucid::sweeps {

/// Linear interpolation between order statistics (Hyndman and Fan 1996, type 7). `sorted` ascending, not empty.
double quantile(std::span<const double> sorted, double q);

/// In any order, not empty.
double median_of(std::vector<double> values);

struct Interval {
  double low = 0;
  double high = 0;
};

/// The percentile bootstrap interval of the median (Efron 1979) at the limit of infinitely many resamples, so that
/// nothing is random: the r-th smallest of n draws with replacement is at most the k-th order statistic exactly when at
/// least r draws fall on the k smallest samples, which is a binomial tail with p = k/n. The median of an even n lies
/// between two ranks; the bounds are taken of the outer one each, which is never too narrow. `sorted` ascending, not
/// empty.
Interval bootstrap_median_interval(std::span<const double> sorted, double confidence = 0.95);

/// The ranks (1-based) of that interval's ends among n sorted samples. Keeps what one n has in common with the next, so
/// that asking for a growing n stays cheap; the answers do not depend on what was asked before.
class MedianIntervalRanks {
 public:
  struct Ranks {
    std::size_t low = 1, high = 1;
  };
  Ranks at(std::size_t n, double confidence = 0.95);

 private:
  double binomial_tail(std::size_t n, double p, std::size_t m);
  std::size_t bootstrap_rank(std::size_t n, std::size_t rank, double q);
  std::vector<double> log_factorial_;
};

struct TimingSummary {
  double median_ms = 0;
  Interval ci95_ms;
  double q25_ms = 0, q75_ms = 0;
  double mean_ms = 0;  ///< what work done every n-th frame costs a frame; the median does not see it
};
TimingSummary summarise(std::span<const double> samples_ms);

/// The most frames that a subject is drawn before its times count.
inline constexpr std::size_t kWarmUpFrames = 64;

/// Warm-up ends when the median of the last kWindow frames differs from that of the kWindow before by at most
/// kTolerance of it, or at the cap.
class WarmUp {
 public:
  static constexpr std::size_t kWindow = 3;
  static constexpr double kTolerance = 0.02;
  WarmUp(std::size_t max_frames, double max_seconds) : max_frames_(max_frames), max_seconds_(max_seconds) {}
  void add(double frame_ms);
  bool done() const { return settled() || capped(); }
  bool settled() const;
  std::size_t frames() const { return frames_ms_.size(); }

 private:
  bool capped() const;
  std::size_t max_frames_;
  double max_seconds_;
  double total_ms_ = 0;
  std::vector<double> frames_ms_;
};

enum class Verdict { more, converged, unconverged };

/// Sampling ends when there are min_samples and the interval of the median is narrow enough (converged), or at
/// max_samples or max_seconds (unconverged). One sample has no interval and never converges. A sample that is not
/// finite or is negative is a bug of the caller.
class StoppingRule {
 public:
  explicit StoppingRule(const TimingLimits& limits) : limits_(limits) {}
  /// `elapsed_s`: wall time since sampling began.
  Verdict add(double frame_ms, double elapsed_s);
  Verdict verdict() const { return verdict_; }
  const std::vector<double>& samples_ms() const { return samples_ms_; }

 private:
  bool narrow_enough();
  TimingLimits limits_;
  std::vector<double> samples_ms_;
  std::vector<double> sorted_ms_;  // the first ones, as of the last check; a check merges in what came since
  MedianIntervalRanks ranks_;
  std::size_t next_check_ = 0;
  Verdict verdict_ = Verdict::more;
};

}  // namespace pellucid::sweeps
