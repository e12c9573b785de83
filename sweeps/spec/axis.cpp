#include "sweeps/spec/axis.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "sweeps/spec/plan.hpp"

namespace pellucid::sweeps {
namespace {

/// The decimal that a person would write for `x`: of twelve digits at most, and no further from it than the
/// arithmetic's rounding, which grows with `scale`. A value without such a decimal (1/3) stays as it is.
double as_written(double x, double scale) {
  const double rounding = 16 * std::numeric_limits<double>::epsilon() * scale;
  if (std::abs(x) <= rounding) return 0;
  const double written = std::stod(fmt::format("{:.11e}", x));
  return std::abs(written - x) <= rounding ? written : x;
}

std::vector<double> doublings(const AxisRange& range) {
  const double octaves = std::log2(range.to / range.from);
  const double whole = std::round(octaves);
  if (std::abs(octaves - whole) > 1e-9) {
    throw InputError(fmt::format("doubling from {} does not meet {}; give a power of two times {}, or `steps`",
                                 range.from, range.to, range.from));
  }
  std::vector<double> values;
  for (int i = 0; i <= static_cast<int>(whole); ++i)
    values.push_back(std::ldexp(range.from, i));
  return values;
}

std::vector<double> evenly(const AxisRange& range) {
  const std::int64_t last = *range.steps - 1;
  std::vector<double> values;
  for (std::int64_t i = 0; i <= last; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(last);
    if (i == 0 || i == last) {
      values.push_back(i == 0 ? range.from : range.to);  // exactly
    } else if (range.log2) {
      const double x = range.from * std::pow(range.to / range.from, t);
      values.push_back(as_written(x, x));
    } else {
      values.push_back(
          as_written(range.from + (range.to - range.from) * t, std::max(std::abs(range.from), std::abs(range.to))));
    }
  }
  return values;
}

}  // namespace

void check_range(const ParameterInfo& info, const AxisRange& range) {
  if (info.type != ValueType::integer && info.type != ValueType::real) {
    throw InputError(fmt::format("a range needs a number, and {} is {}; list its values", info.name,
                                 info.type == ValueType::choice ? "a choice" : "a boolean"));
  }
  if (!std::isfinite(range.from) || !std::isfinite(range.to) || !(range.from < range.to)) {
    throw InputError(fmt::format("a range needs from < to, and {} is not below {}", range.from, range.to));
  }
  if (range.log2 && !(range.from > 0)) {
    throw InputError(fmt::format("a log2 range needs from > 0, and it is {}", range.from));
  }
}

std::vector<Value> expand_range(const ParameterInfo& info, const AxisRange& range) {
  check_range(info, range);
  if (!range.steps && !range.log2) throw InputError("a range needs `steps` or `log2 = true`");
  if (range.steps && (*range.steps < 2 || *range.steps > static_cast<std::int64_t>(kMaxPoints))) {
    throw InputError(fmt::format("steps = {} is out of range [2, {}]", *range.steps, kMaxPoints));
  }
  const std::vector<double> numbers = range.steps ? evenly(range) : doublings(range);

  std::vector<Value> values;
  for (const double number : numbers) {
    if (info.type == ValueType::real) {
      values.emplace_back(number);
      continue;
    }
    const double whole = std::round(number);
    if (std::abs(number - whole) > 1e-9 * std::max(1.0, std::abs(number))) {
      throw InputError(fmt::format("the range falls on {}, and {} is an integer", number, info.name));
    }
    if (!(std::abs(whole) <= 9007199254740992.0)) {  // 2^53: beyond, doubles skip integers
      throw InputError(fmt::format("{} is too large for an integer range", number));
    }
    values.emplace_back(static_cast<std::int64_t>(whole));
  }
  return values;
}

}  // namespace pellucid::sweeps
