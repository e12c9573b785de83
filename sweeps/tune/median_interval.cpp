#include "sweeps/tune/median_interval.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pellucid::sweeps {
namespace {

/// P(Binomial(n, 1/2) ≤ k)
double binomial_below(std::size_t n, std::size_t k) {
  const double size = static_cast<double>(n);
  double sum = 0;
  for (std::size_t i = 0; i <= k; ++i) {
    const double x = static_cast<double>(i);
    sum += std::exp(std::lgamma(size + 1) - std::lgamma(x + 1) - std::lgamma(size - x + 1) - size * std::log(2.0));
  }
  return sum;
}

}  // namespace

double effective_samples(std::span<const double> in_order) {
  const double n = static_cast<double>(in_order.size());
  if (in_order.size() < 8) return n;
  const double median = median_of({in_order.begin(), in_order.end()});
  const auto sign = [&](double x) { return x > median ? 1.0 : x < median ? -1.0 : 0.0; };
  double together = 0;
  double all = 0;
  for (std::size_t i = 0; i < in_order.size(); ++i) {
    all += std::abs(sign(in_order[i]));
    if (i > 0) together += sign(in_order[i]) * sign(in_order[i - 1]);
  }
  if (all == 0) return n;
  const double r = std::clamp(together / all, 0.0, 0.99);
  return std::max(1.0, n * (1 - r) / (1 + r));
}

std::optional<Interval> median_interval(std::span<const double> in_order, double confidence) {
  assert(confidence > 0 && confidence < 1);
  if (in_order.empty()) return std::nullopt;
  const auto n = static_cast<std::size_t>(effective_samples(in_order));
  const double tail = (1 - confidence) / 2;
  if (binomial_below(n, 0) > tail) return std::nullopt;
  std::size_t k = 0;  // the largest such that at most `tail` lies at or below it
  while (k + 1 < n / 2 && binomial_below(n, k + 1) <= tail)
    ++k;
  std::vector<double> sorted(in_order.begin(), in_order.end());
  std::sort(sorted.begin(), sorted.end());
  // The k-th of n effective samples stands for the same share of all of them.
  const auto rank =
      static_cast<std::size_t>(static_cast<double>(k) / static_cast<double>(n) * static_cast<double>(sorted.size()));
  return Interval{sorted[rank], sorted[sorted.size() - 1 - rank]};
}

}  // namespace pellucid::sweeps
