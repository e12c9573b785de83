#pragma once

#include <optional>
#include <span>

#include "sweeps/measure/stopping.hpp"

namespace pellucid::sweeps {

/// How many independent samples a series of frame times is worth: n (1 − r) / (1 + r) with r the correlation of
/// neighbours' signs about the median, since a slow phase lasts many frames. At least 1.
double effective_samples(std::span<const double> in_order);

/// An interval that holds the median of what was sampled with the given confidence, whatever the distribution: order
/// statistics, by the binomial distribution with p = 1/2 (David and Nagaraja 2003, Sec. 7.1), of the effective number
/// of samples. Nothing where the samples are too few for that confidence.
std::optional<Interval> median_interval(std::span<const double> in_order, double confidence);

}  // namespace pellucid::sweeps
