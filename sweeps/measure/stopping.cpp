#include "sweeps/measure/stopping.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace pellucid::sweeps {

double quantile(std::span<const double> sorted, double q) {
  assert(!sorted.empty() && q >= 0 && q <= 1);
  const double at = q * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (at - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

double median_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return quantile(values, 0.5);
}

/// P(Binomial(n, p) ≥ m), summed outwards from the largest term's logarithm so that nothing underflows.
double MedianIntervalRanks::binomial_tail(std::size_t n, double p, std::size_t m) {
  if (m == 0) return 1;
  if (p <= 0) return 0;
  if (p >= 1) return m <= n ? 1 : 0;
  const double size = static_cast<double>(n);
  const double log_p = std::log(p);
  const double log_q = std::log1p(-p);
  double sum = 0;
  for (std::size_t k = m; k <= n; ++k) {
    const double x = static_cast<double>(k);
    const double log_term =
        log_factorial_[n] - log_factorial_[k] - log_factorial_[n - k] + x * log_p + (size - x) * log_q;
    const double term = std::exp(log_term);
    sum += term;
    if (x > size * p && term < 1e-17) break;  // past the mode the terms only fall
  }
  return std::min(sum, 1.0);
}

/// Smallest k (1-based) such that the `rank`-th smallest of n draws lies at or below the k-th order statistic with
/// probability at least q.
std::size_t MedianIntervalRanks::bootstrap_rank(std::size_t n, std::size_t rank, double q) {
  const auto reaches = [&](std::size_t k) {
    return binomial_tail(n, static_cast<double>(k) / static_cast<double>(n), rank) >= q;
  };
  // The answer lies within four standard deviations of the rank, about 4 sqrt(n) / 2; where it should not, look on.
  const auto reach = static_cast<std::size_t>(2 * std::sqrt(static_cast<double>(n))) + 2;
  std::size_t low = rank > reach ? rank - reach : 1;
  std::size_t high = std::min(n, rank + reach);
  if (low > 1 && reaches(low - 1)) low = 1;
  if (!reaches(high)) high = n;
  while (low < high) {
    const std::size_t k = low + (high - low) / 2;
    if (reaches(k)) {
      high = k;
    } else {
      low = k + 1;
    }
  }
  return low;
}

MedianIntervalRanks::Ranks MedianIntervalRanks::at(std::size_t n, double confidence) {
  assert(n > 0 && confidence > 0 && confidence < 1);
  for (std::size_t k = log_factorial_.size(); k <= n; ++k)
    log_factorial_.push_back(std::lgamma(static_cast<double>(k) + 1));
  const double tail = (1 - confidence) / 2;
  const std::size_t lower_middle = (n + 1) / 2;
  const std::size_t upper_middle = n / 2 + 1;
  return {bootstrap_rank(n, lower_middle, tail), bootstrap_rank(n, upper_middle, 1 - tail)};
}

Interval bootstrap_median_interval(std::span<const double> sorted, double confidence) {
  assert(!sorted.empty());
  const MedianIntervalRanks::Ranks ranks = MedianIntervalRanks().at(sorted.size(), confidence);
  return {sorted[ranks.low - 1], sorted[ranks.high - 1]};
}

TimingSummary summarise(std::span<const double> samples_ms) {
  std::vector<double> sorted(samples_ms.begin(), samples_ms.end());
  std::sort(sorted.begin(), sorted.end());
  return {quantile(sorted, 0.5), bootstrap_median_interval(sorted), quantile(sorted, 0.25), quantile(sorted, 0.75),
          std::accumulate(sorted.begin(), sorted.end(), 0.0) / static_cast<double>(sorted.size())};
}

void WarmUp::add(double frame_ms) {
  total_ms_ += frame_ms;
  frames_ms_.push_back(frame_ms);
}

bool WarmUp::settled() const {
  if (frames_ms_.size() < 2 * kWindow) return false;
  const auto window = static_cast<std::ptrdiff_t>(kWindow);
  const double last = median_of({frames_ms_.end() - window, frames_ms_.end()});
  const double before = median_of({frames_ms_.end() - 2 * window, frames_ms_.end() - window});
  return std::abs(last - before) <= kTolerance * before;
}

bool WarmUp::capped() const {
  return frames_ms_.size() >= max_frames_ || total_ms_ >= 1000 * max_seconds_;
}

bool StoppingRule::narrow_enough() {
  if (samples_ms_.size() < 2) return false;
  const auto known = static_cast<std::ptrdiff_t>(sorted_ms_.size());
  sorted_ms_.insert(sorted_ms_.end(), samples_ms_.begin() + known, samples_ms_.end());
  std::sort(sorted_ms_.begin() + known, sorted_ms_.end());
  std::inplace_merge(sorted_ms_.begin(), sorted_ms_.begin() + known, sorted_ms_.end());
  const MedianIntervalRanks::Ranks ranks = ranks_.at(sorted_ms_.size());
  const double half_width = (sorted_ms_[ranks.high - 1] - sorted_ms_[ranks.low - 1]) / 2;
  return half_width <= limits_.relative_ci * quantile(sorted_ms_, 0.5);
}

Verdict StoppingRule::add(double frame_ms, double elapsed_s) {
  assert(verdict_ == Verdict::more && std::isfinite(frame_ms) && frame_ms >= 0);
  samples_ms_.push_back(frame_ms);
  const std::size_t n = samples_ms_.size();
  const bool capped = n >= static_cast<std::size_t>(limits_.max_samples) || elapsed_s >= limits_.max_seconds;
  const bool enough = n >= static_cast<std::size_t>(limits_.min_samples);
  // Checking after every sample would let a lucky moment through, and cost n log n each time: check in growing steps.
  if (enough && (n >= next_check_ || capped)) {
    if (narrow_enough()) return verdict_ = Verdict::converged;
    next_check_ = n + std::max<std::size_t>(5, n / 10);
  }
  if (capped) verdict_ = Verdict::unconverged;
  return verdict_;
}

}  // namespace pellucid::sweeps
