#include "plots/charts/ticks.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace pellucid::plots {
namespace {

/// Share of the axis that is kept free at either end of a logarithmic range, so that markers are not cut.
constexpr double kLogPadding = 0.055;

double forward(Scale scale, double value) {
  switch (scale) {
    case Scale::linear:
      return value;
    case Scale::log2:
      return std::log2(value);
    case Scale::log10:
      return std::log10(value);
  }
  return value;
}

double backward(Scale scale, double position) {
  switch (scale) {
    case Scale::linear:
      return position;
    case Scale::log2:
      return std::exp2(position);
    case Scale::log10:
      return std::pow(10.0, position);
  }
  return position;
}

/// The step of the form 1, 2 or 5 times a power of ten that gives at most `wanted` intervals.
double nice_step(double span, int wanted) {
  const double rough = span / std::max(wanted, 1);
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= rough * (1 - 1e-9)) return factor * decade;
  }
  return 10 * decade;
}

AxisLayout linear_axis(const Axis& axis, double low, double high, int wanted) {
  AxisLayout layout;
  if (axis.from_zero) {
    low = std::min(low, 0.0);
    high = std::max(high, 0.0);
  }
  // Values that differ by rounding alone are one value; so are those that no label could tell apart.
  const double size = std::max(std::abs(low), std::abs(high));
  if (high - low <= std::max(1e-9 * size, kLeastShown)) {
    const double around = size <= kLeastShown ? 1 : size * 0.5;
    high += around;
    if (!axis.from_zero || low != 0) low -= around;
  }
  const double step = nice_step(high - low, wanted);
  // The ends go to whole steps, and one further where a value would sit on the edge (but not below a zero).
  double first = std::floor(low / step + 1e-9);
  double last = std::ceil(high / step - 1e-9);
  if (first * step > low - 0.02 * step && !(axis.from_zero && first == 0)) first -= low < 0 || first > 0 ? 1 : 0;
  if (last * step < high + 0.02 * step) last += high > 0 || last < 0 ? 1 : 0;
  layout.min = first * step;
  layout.max = last * step;
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  for (double k = first; k <= last + 0.5; k += 1) {
    layout.ticks.push_back({k * step, decimal_label(k * step, decimals)});
  }
  return layout;
}

/// Widens [low, high] by the padding, in the axis's own measure.
void pad(AxisLayout& layout, double low, double high, double least) {
  double a = forward(layout.scale, low);
  double b = forward(layout.scale, high);
  if (b - a < least) {
    const double missing = (least - (b - a)) / 2;
    a -= missing;
    b += missing;
  }
  const double padding = (b - a) * kLogPadding;
  const double most = forward(layout.scale, std::numeric_limits<double>::max() / 10);
  layout.min = backward(layout.scale, std::max(a - padding, -most));
  layout.max = backward(layout.scale, std::min(b + padding, most));
}

AxisLayout binary_axis(double low, double high, int wanted) {
  AxisLayout layout;
  layout.scale = Scale::log2;
  pad(layout, low, high, 1.0);
  const int first = static_cast<int>(std::ceil(std::log2(layout.min)));
  const int last = static_cast<int>(std::floor(std::log2(layout.max)));
  const int stride = (last - first) / std::max(wanted, 1) + 1;
  for (int k = first; k <= last; ++k) {
    const double value = std::exp2(k);
    layout.ticks.push_back({value, (k - first) % stride == 0 ? binary_label(value) : std::string()});
  }
  return layout;
}

/// A digit times a power of ten, without an exponent.
std::string plain_label(double value) {
  const int exponent = static_cast<int>(std::floor(std::log10(value) + 1e-9));
  return fmt::format("{:.{}f}", value, std::max(0, -exponent));
}

AxisLayout decimal_log_axis(double low, double high, int wanted) {
  AxisLayout layout;
  layout.scale = Scale::log10;
  pad(layout, low, high, 0.5);
  const int first = static_cast<int>(std::floor(std::log10(layout.min)));
  const int last = static_cast<int>(std::ceil(std::log10(layout.max)));
  int decades_inside = 0;
  for (int k = first; k <= last; ++k) {
    const double value = std::pow(10.0, k);
    decades_inside += value >= layout.min && value <= layout.max ? 1 : 0;
  }
  // With less than two whole decades 2 and 5 carry labels too, or there would be nothing to read a value from.
  const bool dense = decades_inside < 3;
  // One notation for the whole axis: decimals where all of them are short.
  const bool plain = layout.min > 0.9e-4 && layout.max < 2e4;
  const int stride = std::max(0, decades_inside - 1) / std::max(wanted, 1) + 1;
  for (int k = first; k <= last; ++k) {
    for (int digit = 1; digit <= 9; ++digit) {
      const double value = digit * std::pow(10.0, k);
      if (value < layout.min * (1 - 1e-12) || value > layout.max * (1 + 1e-12)) continue;
      const bool major = (digit == 1 && (k - first) % stride == 0) || (dense && (digit == 2 || digit == 5));
      if (!major && last - first > 4) continue;
      layout.ticks.push_back({value, major ? (plain ? plain_label(value) : power_label(value)) : std::string()});
    }
  }
  return layout;
}

}  // namespace

double AxisLayout::position(double value) const {
  const double a = forward(scale, min);
  const double b = forward(scale, max);
  return (forward(scale, value) - a) / (b - a);
}

bool drawable(double value, Scale scale) {
  const double size = std::abs(value);
  return size <= kMostShown && (scale == Scale::linear || size == 0 || size >= kLeastShown);
}

AxisLayout lay_out_axis(const Axis& axis, double low, double high, int wanted) {
  assert(std::isfinite(low) && std::isfinite(high) && low <= high);
  assert(axis.scale == Scale::linear || low > 0);
  switch (axis.scale) {
    case Scale::linear:
      return linear_axis(axis, low, high, wanted);
    case Scale::log2:
      return binary_axis(low, high, wanted);
    case Scale::log10:
      return decimal_log_axis(low, high, wanted);
  }
  return {};
}

std::string decimal_label(double value, int decimals) {
  if (value == 0) return "0";
  const double size = std::abs(value);
  if (size < 1e6 && decimals <= 5) return fmt::format("{:.{}f}", value, decimals);
  // As many digits as tell it from the next tick.
  const int exponent = static_cast<int>(std::floor(std::log10(size) + 1e-9));
  const int digits = exponent + decimals + 1;
  if (digits > 3 && size < 1e12 && decimals <= 12) return fmt::format("{:.{}f}", value, decimals);
  return fmt::format("{:.{}g}e{}", value / std::pow(10.0, exponent), std::clamp(digits, 3, 16), exponent);
}

std::string power_label(double value) {
  const int exponent = static_cast<int>(std::floor(std::log10(value) + 1e-9));
  const double mantissa = value / std::pow(10.0, exponent);
  if (exponent >= -3 && exponent <= 3) return fmt::format("{:.{}f}", value, std::max(0, -exponent));
  // VTK's font has no raised digits but ² and ³; an exponent that is not drawn is a wrong number.
  return fmt::format("{:.0f}e{}", mantissa, exponent);
}

std::string binary_label(double value) {
  const int exponent = static_cast<int>(std::lround(std::log2(value)));
  if (exponent >= 0 && exponent <= 20) return fmt::format("{:.0f}", value);
  if (exponent < 0 && exponent >= -10) return fmt::format("1/{:.0f}", 1 / value);
  return fmt::format("2^{}", exponent);
}

}  // namespace pellucid::plots
