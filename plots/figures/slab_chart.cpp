#include "plots/figures/slab_chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "plots/charts/style.hpp"

namespace pellucid::plots {
namespace {

/// Angle to the normal [rad] and radiance [1/sr], by angle.
using Curve = std::vector<std::pair<double, double>>;

Curve curve_of(const SlabChart& wanted, const scattering::SlabLight& light) {
  const std::vector<double>& radiance =
      wanted.show == SlabChart::Show::transmission ? light.transmission : light.reflection;
  Curve curve;
  for (std::size_t i = 0; i < radiance.size(); ++i)
    curve.emplace_back(std::acos(light.cosine[i]), radiance[i]);
  std::sort(curve.begin(), curve.end());
  return curve;
}

std::vector<Point> points_of(const Curve& curve, bool polar) {
  std::vector<Point> points;
  if (!polar) {
    for (const auto& [angle, radiance] : curve)
      points.push_back({angle * 180 / std::numbers::pi, radiance});
    return points;
  }
  // From one side over the normal to the other.
  for (auto at = curve.rbegin(); at != curve.rend(); ++at)
    points.push_back({-at->second * std::sin(at->first), at->second * std::cos(at->first)});
  for (const auto& [angle, radiance] : curve)
    points.push_back({radiance * std::sin(angle), radiance * std::cos(angle)});
  return points;
}

}  // namespace

Chart chart_of_slabs(const SlabChart& wanted) {
  Chart chart;
  chart.title = wanted.title;
  chart.note = fmt::format(
      "A beam of unit flux, perpendicular to the slab; its unscattered part is left out. Anisotropy {}, albedo {}.",
      wanted.medium.anisotropy, wanted.medium.albedo);
  const bool through = wanted.show == SlabChart::Show::transmission;
  if (wanted.polar) {
    chart.x = {.label = "radiance along the slab", .unit = "1/sr", .field = "radiance_along"};
    chart.y = {.label = "radiance along its normal", .unit = "1/sr", .from_zero = true, .field = "radiance_normal"};
    chart.height_px = chart.width_px;
  } else {
    chart.x = {.label = "angle to the normal", .unit = "deg", .from_zero = true, .field = "angle_deg"};
    chart.y = {.label = through ? "transmitted radiance" : "reflected radiance",
               .unit = "1/sr",
               .from_zero = true,
               .field = "radiance"};
  }
  const scattering::Slab slab(wanted.medium, kSlabOrdinates);
  for (std::size_t i = 0; i < wanted.depths.size(); ++i) {
    Style look = style(i);
    look.marker = Marker::none;
    const std::string name = fmt::format("τ = {}", wanted.depths[i]);
    chart.series.push_back({.label = name,
                            .points = points_of(curve_of(wanted, slab.light(wanted.depths[i])), wanted.polar),
                            .style = look,
                            .name = name});
  }
  return chart;
}

}  // namespace pellucid::plots
