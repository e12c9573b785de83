#include "sweeps/tune/surrogate.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

namespace pellucid::sweeps {
namespace {

constexpr std::array<double, 5> kLengths{0.25, 0.5, 1.0, 2.0, 4.0};
constexpr double kPlane = 4;  ///< prior variance of the plane's slopes, in units of the values' own variance

/// The plane's part and the smooth one (Matérn, twice differentiable).
double kernel(const std::vector<double>& a, const std::vector<double>& b, double length) {
  double product = 1;
  double square = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    product += (a[i] - 0.5) * (b[i] - 0.5);
    square += (a[i] - b[i]) * (a[i] - b[i]);
  }
  const double r = std::sqrt(5 * square) / length;
  return kPlane * product + (1 + r + r * r / 3) * std::exp(-r);
}

}  // namespace

Surrogate::Surrogate(std::vector<std::vector<double>> places, std::vector<double> values, double noise)
    : places_(std::move(places)), values_(std::move(values)), noise_(noise) {
  assert(!places_.empty() && places_.size() == values_.size());
  const double n = static_cast<double>(values_.size());
  center_ = std::accumulate(values_.begin(), values_.end(), 0.0) / n;
  double square = 0;
  for (double& value : values_) {
    value -= center_;
    square += value * value;
  }
  scale_ = std::max(std::sqrt(square / n), 1e-9);
  for (double& value : values_)
    value /= scale_;
  noise_ = std::max(noise / scale_, 1e-3);
  double best = -1e300;
  double chosen = kLengths.back();
  for (const double length : kLengths) {
    if (fit(length) && log_likelihood_ > best) {
      best = log_likelihood_;
      chosen = length;
    }
  }
  fit(chosen);
}

bool Surrogate::fit(double length) {
  length_ = length;
  const std::size_t n = places_.size();
  factor_.assign(n * n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = kernel(places_[i], places_[j], length) + (i == j ? noise_ * noise_ : 0);
      for (std::size_t k = 0; k < j; ++k)
        sum -= factor_[i * n + k] * factor_[j * n + k];
      if (i == j && sum <= 0) return false;
      factor_[i * n + j] = i == j ? std::sqrt(sum) : sum / factor_[j * n + j];
    }
  }
  weights_ = values_;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k)
      weights_[i] -= factor_[i * n + k] * weights_[k];
    weights_[i] /= factor_[i * n + i];
  }
  log_likelihood_ = 0;
  for (std::size_t i = 0; i < n; ++i)
    log_likelihood_ -= weights_[i] * weights_[i] / 2 + std::log(factor_[i * n + i]);
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k)
      weights_[i] -= factor_[k * n + i] * weights_[k];
    weights_[i] /= factor_[i * n + i];
  }
  return true;
}

std::vector<double> Surrogate::kernel_to(const std::vector<double>& place) const {
  std::vector<double> result;
  result.reserve(places_.size());
  for (const std::vector<double>& known : places_)
    result.push_back(kernel(known, place, length_));
  return result;
}

Prediction Surrogate::at(const std::vector<double>& place) const {
  const std::size_t n = places_.size();
  std::vector<double> k = kernel_to(place);
  const double mean = std::inner_product(k.begin(), k.end(), weights_.begin(), 0.0);
  double variance = kernel(place, place, length_);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j)
      k[i] -= factor_[i * n + j] * k[j];
    k[i] /= factor_[i * n + i];
    variance -= k[i] * k[i];
  }
  return {center_ + scale_ * mean, scale_ * std::sqrt(std::max(variance, 0.0))};
}

}  // namespace pellucid::sweeps
