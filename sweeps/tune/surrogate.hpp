#pragma once

#include <cstddef>
#include <vector>

namespace pellucid::sweeps {

/// The expected value of a function at a place where it has not been measured.
struct Prediction {
  double mean = 0;
  double deviation = 0;
};

/// A Gaussian process over a small set of measurements: a plane plus a smooth remainder whose length scale is the one
/// of a few that makes the measurements likeliest (Rasmussen and Williams 2006, Sec. 2.7 and 5.4.1). Coordinates are
/// about [0, 1] each; values of any scale.
class Surrogate {
 public:
  /// `noise`: standard deviation of a value's measurement.
  Surrogate(std::vector<std::vector<double>> places, std::vector<double> values, double noise);
  Prediction at(const std::vector<double>& place) const;

 private:
  bool fit(double length);
  std::vector<double> kernel_to(const std::vector<double>& place) const;

  std::vector<std::vector<double>> places_;
  std::vector<double> values_;  // standardised
  double noise_, center_ = 0, scale_ = 1, length_ = 1;
  std::vector<double> factor_;  // lower triangle of Cholesky's, by rows
  std::vector<double> weights_;
  double log_likelihood_ = 0;
};

}  // namespace pellucid::sweeps
