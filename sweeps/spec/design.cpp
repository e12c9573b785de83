#include "sweeps/spec/design.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <random>
#include <string>
#include <utility>

#include <boost/random/sobol.hpp>
#include <fmt/format.h>

namespace pellucid::sweeps {
namespace {

/// 53 bits of the generator as a real of [0, 1); the library's own distributions differ between implementations.
double unit(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

using Points = std::vector<std::vector<double>>;

Points random_points(const Design& design, std::size_t dimensions) {
  std::mt19937_64 random(design.seed);
  Points points(static_cast<std::size_t>(design.count), std::vector<double>(dimensions));
  for (std::vector<double>& point : points) {
    for (double& u : point)
      u = unit(random());
  }
  return points;
}

Points latin_points(const Design& design, std::size_t dimensions) {
  std::mt19937_64 random(design.seed);
  const auto count = static_cast<std::size_t>(design.count);
  Points points(count, std::vector<double>(dimensions));
  std::vector<std::size_t> parts(count);
  for (std::size_t d = 0; d < dimensions; ++d) {
    for (std::size_t i = 0; i < count; ++i)
      parts[i] = i;
    for (std::size_t i = count; i > 1; --i)
      std::swap(parts[i - 1], parts[random() % i]);
    for (std::size_t i = 0; i < count; ++i)
      points[i][d] = (static_cast<double>(parts[i]) + unit(random())) / static_cast<double>(count);
  }
  return points;
}

/// Adding the same random bits to every point (a digital shift) keeps the sequence's uniformity and makes the seed
/// count.
Points sobol_points(const Design& design, std::size_t dimensions) {
  std::mt19937_64 random(design.seed);
  std::vector<std::uint64_t> shift(dimensions);
  for (std::uint64_t& bits : shift)
    bits = random();
  boost::random::sobol sequence(dimensions);
  Points points(static_cast<std::size_t>(design.count), std::vector<double>(dimensions));
  for (std::vector<double>& point : points) {
    for (std::size_t d = 0; d < dimensions; ++d)
      point[d] = unit(sequence() ^ shift[d]);
  }
  return points;
}

}  // namespace

Points unit_points(const Design& design, std::size_t dimensions) {
  assert(design.count > 0 && dimensions > 0 && dimensions <= kMaxDesignAxes);
  switch (design.kind) {
    case DesignKind::random:
      return random_points(design, dimensions);
    case DesignKind::latin_hypercube:
      return latin_points(design, dimensions);
    case DesignKind::sobol:
      break;
  }
  return sobol_points(design, dimensions);
}

Value value_at(const ParameterInfo& info, const AxisRange& range, double u) {
  check_range(info, range);
  const bool whole = info.type == ValueType::integer;
  // An integer stands for the interval around it, so that both ends are as likely as the others.
  const double from = whole && !range.log2 ? range.from - 0.5 : range.from;
  const double to = whole && !range.log2 ? range.to + 0.5 : range.to;
  const double x = range.log2 ? from * std::pow(to / from, u) : from + (to - from) * u;
  if (whole) return static_cast<std::int64_t>(std::clamp(std::round(x), range.from, range.to));
  return std::clamp(std::stod(fmt::format("{:.6g}", x)), range.from, range.to);
}

}  // namespace pellucid::sweeps
