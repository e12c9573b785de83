#include "algorithms/reference/media/scattering.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace pellucid {
namespace {

double largest(const glm::dvec3& v) {
  return std::max({v.x, v.y, v.z});
}

}  // namespace

// Part of a span, cut into equal parts, and what is known of its share of the pixel.
struct Scattering::Step {
  std::size_t span = 0;
  double from = 0.0, to = 1.0;  // s
  double depth = 0.0;           // τ before the span
  unsigned lights = 0;          // that reach it
  int parts = 1;
  glm::dvec3 radiance{0.0};
  double change = 0.0;  // by the last doubling of `parts`
};

Scattering::Scratch::Scratch() = default;
Scattering::Scratch::~Scratch() = default;

Scattering::Scattering(const Scene& scene, const Volume& volume)
    : light_(scene),
      grid_(volume),
      light_path_(scene, volume, light_),
      emission_(volume.emission),
      in_light_space_(volume.light >= 0) {
  for (std::size_t i = 0; i < light_.light_count(); ++i) {
    if (in_light_space_ || light_.lights()[i].kind != LightKind::directional) varying_lights_ |= 1U << i;
  }
}

bool Scattering::constant_source(const CellSpan& span, unsigned lights) const {
  const bool constant_density = span.density[1] == 0.0 && span.density[2] == 0.0 && span.density[3] == 0.0;
  return (lights & varying_lights_) == 0 && (constant_density || grid_.transfer().constant_albedo(span.piece));
}

// C = emission + albedo · (ambient + Σ V E / 4π)
glm::dvec3 Scattering::source(const CellSpan& span, double s, unsigned lights, const glm::dvec3& point) const {
  glm::dvec3 irradiance(0.0);
  for (std::size_t i = 0; i < light_.light_count(); ++i) {
    if ((lights >> i & 1U) == 0) continue;
    irradiance += in_light_space_ ? light_.lights()[i].intensity * value(span.scattering, s)
                                  : light_.incidence(i, point).irradiance;
  }
  return emission_ + grid_.transfer().albedo(span.piece, value(span.density, s)) *
                         (light_.ambient() + irradiance / (4.0 * std::numbers::pi));
}

// ∫ σ C T dt over a step with three-point Gauss–Legendre quadrature on each of its parts.
glm::dvec3 Scattering::integrate(const Ray& ray, const CellSpan& span, const Step& step) const {
  static const double offset = std::sqrt(0.15);
  const std::array<double, 3> nodes = {0.5 - offset, 0.5, 0.5 + offset};
  constexpr std::array<double, 3> kWeights = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  const double width = (step.to - step.from) / step.parts;
  glm::dvec3 sum(0.0);
  for (int part = 0; part < step.parts; ++part) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const double s = step.from + (part + nodes[i]) * width;
      const double absorbed = kWeights[i] * span.sigma(s) * std::exp(-step.depth - span.depth(s));
      sum += absorbed * source(span, s, step.lights, ray.origin + (span.begin_m + s * span.length_m) * ray.direction);
    }
  }
  return sum * (span.length_m * width);
}

// Finds the spans, and the steps whose source varies; the others are added at once.
void Scattering::cut(const Ray& ray, const Interval& inside, Scratch& scratch, ScatteredLight& result) const {
  light_path_.find(ray.origin, ray.direction, inside, scratch.light_path, scratch.lit);
  scratch.spans.clear();
  scratch.steps.clear();
  double depth = 0.0;
  std::size_t part = 0;
  grid_.trace(ray.origin, ray.direction, inside, [&](const CellSpan& span) {
    const std::size_t index = scratch.spans.size();
    scratch.spans.push_back(span);
    const double end_m = span.begin_m + span.length_m;
    while (part + 1 < scratch.lit.size() && scratch.lit[part].end_m <= span.begin_m)
      ++part;
    double from = 0.0;
    while (from < 1.0) {
      const bool last = part + 1 == scratch.lit.size() || scratch.lit[part].end_m >= end_m;
      const double to = last ? 1.0 : std::clamp((scratch.lit[part].end_m - span.begin_m) / span.length_m, from, 1.0);
      const unsigned lights = scratch.lit[part].lights;
      if (to > from) {
        if (constant_source(span, lights)) {
          // ∫ C dT
          const double before = span.depth(from);
          result.radiance +=
              std::exp(-depth - before) * -std::expm1(before - span.depth(to)) * source(span, from, lights, ray.origin);
        } else {
          scratch.steps.push_back({index, from, to, depth, lights, 1, glm::dvec3(0.0), 0.0});
        }
      }
      from = to;
      if (last) break;
      ++part;
    }
    depth += span.depth(1.0);
  });
  result.transmittance = std::exp(-depth);
}

void Scattering::refine(const Ray& ray, const ReferenceOptions& options, Scratch& scratch,
                        ScatteredLight& result) const {
  std::vector<Step>& steps = scratch.steps;
  const auto count = static_cast<double>(steps.size());
  const int least = std::max(1, static_cast<int>(std::ceil(options.min_steps / count)));
  double total = 0.0;
  const auto refine_step = [&](Step& step) {
    total += step.parts;  // as many again
    step.parts *= 2;
    const glm::dvec3 finer = integrate(ray, scratch.spans[step.span], step);
    step.change = largest(glm::abs(finer - step.radiance));
    step.radiance = finer;
  };
  for (Step& step : steps) {
    step.parts = least;
    total += least;
    step.radiance = integrate(ray, scratch.spans[step.span], step);
    refine_step(step);
  }
  const auto error = [&] {
    double sum = 0.0;
    for (const Step& step : steps)
      sum += step.change;
    return sum;
  };
  // Where half the tolerance is left if all changed as little, a step needs no more parts.
  const double negligible = 0.5 * options.tolerance / count;
  for (result.step_error = error(); result.step_error >= options.tolerance; result.step_error = error()) {
    double wanted = 0.0;
    for (const Step& step : steps)
      wanted += step.change > negligible ? step.parts : 0;
    if (total + wanted > options.max_steps) break;
    for (Step& step : steps) {
      if (step.change > negligible) refine_step(step);
    }
  }
  result.converged = result.step_error < options.tolerance;
  for (const Step& step : steps)
    result.radiance += step.radiance;
}

ScatteredLight Scattering::along(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside,
                                 const ReferenceOptions& options, Scratch& scratch) const {
  ScatteredLight result;
  if (light_path_.plain() && grid_.transfer().pieces().size() == 1) {
    // A constant C leaves ∫ C dT: exact, since the optical depth is.
    const double depth = grid_.optical_depth(origin, direction, inside);
    result.transmittance = std::exp(-depth);
    result.radiance = -std::expm1(-depth) * source(CellSpan{}, 0.0, ~0U, origin);
    return result;
  }
  const Ray ray{origin, direction};
  cut(ray, inside, scratch, result);
  if (!scratch.steps.empty()) refine(ray, options, scratch, result);
  return result;
}

}  // namespace pellucid
