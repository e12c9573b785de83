#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sweeps/spec/axis.hpp"

/// Space-filling designs: points spread over the ranges of several parameters at once, where a grid would need too
/// many.
namespace pellucid::sweeps {

enum class DesignKind {
  random,           ///< independent and uniform
  latin_hypercube,  ///< each axis cut into `count` equal parts, one point in each (McKay et al. 1979)
  sobol             ///< a digital sequence with the direction numbers of Joe and Kuo 2008, shifted by the seed
};

struct Design {
  DesignKind kind = DesignKind::sobol;
  int count = 0;
  std::uint64_t seed = 1;
};

inline constexpr std::size_t kMaxDesignAxes = 1000;

/// `count` points of the unit cube, each of `dimensions` coordinates in [0, 1). The same design gives the same points
/// on every machine. A longer Sobol design begins with the points of a shorter one.
std::vector<std::vector<double>> unit_points(const Design&, std::size_t dimensions);

/// The value at `u` in [0, 1) of a range: evenly spread, in the logarithm with `log2`. Reals are rounded to six
/// significant digits, so that they can be typed again; each integer of the range is equally likely. Throws InputError
/// without a position, as expand_range does.
Value value_at(const ParameterInfo&, const AxisRange&, double u);

}  // namespace pellucid::sweeps
