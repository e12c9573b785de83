#pragma once

#include <string>
#include <vector>

#include "plots/charts/chart.hpp"

namespace pellucid::plots {

struct Tick {
  double value = 0;
  std::string label;  ///< empty for a minor tick
};

/// The range that an axis shows and its ticks, which lie inside the range.
struct AxisLayout {
  double min = 0, max = 1;
  Scale scale = Scale::linear;
  std::vector<Tick> ticks;

  /// Position of a value along the axis: 0 at the lower end, 1 at the upper.
  double position(double value) const;
};

/// Range and ticks for data that span [low, high]; both are finite, and positive on a logarithmic axis. `wanted` is
/// about how many labels there is room for.
AxisLayout lay_out_axis(const Axis&, double low, double high, int wanted);

/// Between these a value can be laid out without leaving what a double holds.
inline constexpr double kLeastShown = 1e-300, kMostShown = 1e300;
bool drawable(double value, Scale);

/// "0.001", "2e-5", "1/4": short, and exact for the values that ticks take.
std::string decimal_label(double value, int decimals);
std::string power_label(double value);   ///< for logarithmic axes to base 10
std::string binary_label(double value);  ///< for logarithmic axes to base 2

}  // namespace pellucid::plots
