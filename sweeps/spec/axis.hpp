#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "algorithms/parameters.hpp"

namespace pellucid::sweeps {

/// `{ from, to, steps, log2 }` of a spec.
struct AxisRange {
  double from = 0;
  double to = 0;
  std::optional<std::int64_t> steps;  ///< values, both ends included; at least 2
  bool log2 = false;                  ///< without steps: doubling from `from` to `to`, which must be hit
};

/// Throws InputError, without a position, unless the parameter is a number and the range ascends between finite ends.
void check_range(const ParameterInfo&, const AxisRange&);

/// The values of a range for a parameter of integer or real type, in its own type. An integer parameter takes only
/// ranges that fall on integers; reals are the decimals that a person would write (0.9, not 0.8999999999999999). Throws
/// InputError without a position. Does not check the parameter's own range.
std::vector<Value> expand_range(const ParameterInfo&, const AxisRange&);

}  // namespace pellucid::sweeps
