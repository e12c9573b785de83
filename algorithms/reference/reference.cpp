#include "algorithms/reference/reference.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <optional>

#include <tbb/blocked_range.h>
#include <tbb/combinable.h>
#include <tbb/parallel_for.h>

#include "algorithms/reference/medium_path.hpp"
#include "algorithms/reference/shading.hpp"

namespace pellucid {
namespace {

struct Ray {
  glm::dvec3 origin;
  glm::dvec3 direction;
};

// Light that the medium adds along a ray, and what it lets through.
struct MediumLight {
  glm::dvec3 radiance{0.0};
  double transmittance = 1.0;
  double step_error = 0.0;
  bool converged = true;
};

double largest(const glm::dvec3& v) {
  return std::max({v.x, v.y, v.z});
}

// The medium of a scene, ready for rays.
class Medium {
 public:
  Medium(const Scene& scene, const Volume& volume)
      : light_(scene), grid_(volume), albedo_(volume.albedo), emission_(volume.emission), uniform_(light_.uniform()) {}

  const MediumGrid& grid() const { return grid_; }

  // `scratch` spares an allocation for each ray.
  struct Step;
  MediumLight along(const Ray& ray, const Interval& inside, const ReferenceOptions& options,
                    std::vector<Step>& scratch) const;

 private:
  glm::dvec3 source(const glm::dvec3& point) const { return light_.medium_radiance(point, albedo_, emission_); }
  glm::dvec3 integrate(const Ray& ray, const Step& step) const;

  Illumination light_;
  MediumGrid grid_;
  glm::dvec3 albedo_, emission_;
  bool uniform_;
};

// A span, cut into equal parts, and what is known of its share of the pixel.
struct Medium::Step {
  CellSpan span;
  double depth = 0.0;  // τ before the span
  int parts = 1;
  glm::dvec3 radiance{0.0};
  double change = 0.0;  // by the last doubling of `parts`
};

// ∫ σ C T dt over a span with three-point Gauss–Legendre quadrature on each of its parts.
glm::dvec3 Medium::integrate(const Ray& ray, const Step& step) const {
  static const double offset = std::sqrt(0.15);
  const std::array<double, 3> nodes = {0.5 - offset, 0.5, 0.5 + offset};
  constexpr std::array<double, 3> kWeights = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  const CellSpan& span = step.span;
  glm::dvec3 sum(0.0);
  for (int part = 0; part < step.parts; ++part) {
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const double s = (part + nodes[i]) / step.parts;
      const double absorbed = kWeights[i] * span.sigma(s) * std::exp(-step.depth - span.depth(s));
      sum += absorbed * source(ray.origin + (span.begin_m + s * span.length_m) * ray.direction);
    }
  }
  return sum * (span.length_m / step.parts);
}

MediumLight Medium::along(const Ray& ray, const Interval& inside, const ReferenceOptions& options,
                          std::vector<Step>& steps) const {
  MediumLight result;
  if (uniform_) {
    // A constant C leaves ∫ C dT: exact, since the optical depth is.
    const double depth = grid_.optical_depth(ray.origin, ray.direction, inside);
    result.transmittance = std::exp(-depth);
    result.radiance = -std::expm1(-depth) * source(ray.origin);
    return result;
  }
  steps.clear();
  double depth = 0.0;
  grid_.trace(ray.origin, ray.direction, inside, [&](const CellSpan& span) {
    steps.push_back({span, depth, 1, glm::dvec3(0.0), 0.0});
    depth += span.depth(1.0);
  });
  if (steps.empty()) return result;
  result.transmittance = std::exp(-depth);

  const auto count = static_cast<double>(steps.size());
  const int least = std::max(1, static_cast<int>(std::ceil(options.min_steps / count)));
  double total = 0.0;
  const auto refine = [&](Step& step) {
    total += step.parts;  // as many again
    step.parts *= 2;
    const glm::dvec3 finer = integrate(ray, step);
    step.change = largest(glm::abs(finer - step.radiance));
    step.radiance = finer;
  };
  for (Step& step : steps) {
    step.parts = least;
    total += least;
    step.radiance = integrate(ray, step);
    refine(step);
  }
  const auto error = [&] {
    double sum = 0.0;
    for (const Step& step : steps)
      sum += step.change;
    return sum;
  };
  // Where half the tolerance is left if all changed as little, a span needs no more parts.
  const double negligible = 0.5 * options.tolerance / count;
  for (result.step_error = error(); result.step_error >= options.tolerance; result.step_error = error()) {
    double wanted = 0.0;
    for (const Step& step : steps)
      wanted += step.change > negligible ? step.parts : 0;
    if (total + wanted > options.max_steps) break;
    for (Step& step : steps) {
      if (step.change > negligible) refine(step);
    }
  }
  result.converged = result.step_error < options.tolerance;
  for (const Step& step : steps)
    result.radiance += step.radiance;
  return result;
}

struct Errors {
  double max = 0.0;
  double sum = 0.0;
  std::size_t unconverged = 0;
};

}  // namespace

Reference render_reference(const Scene& scene, const Camera& camera, const SurfaceLayer& surfaces,
                           const ReferenceOptions& options) {
  const auto width = static_cast<std::size_t>(camera.width), height = static_cast<std::size_t>(camera.height);
  assert(surfaces.radiance.width == camera.width && surfaces.radiance.height == camera.height);
  assert(surfaces.radiance.channels >= 3 && surfaces.distance_m.size() == width * height);
  assert(options.tolerance > 0.0 && options.min_steps >= 1 && options.max_steps >= options.min_steps);

  Reference result;
  result.image = Image(camera.width, camera.height, 4);
  result.mask = Image(camera.width, camera.height, 1);
  std::optional<Medium> medium;
  if (scene.volume) medium.emplace(scene, *scene.volume);
  const glm::dvec3 eye(camera.view.eye);
  const glm::dvec3 forward = glm::normalize(glm::dvec3(camera.view.target) - eye);
  tbb::combinable<Errors> errors;
  std::atomic<int> rows_done{0};

  tbb::parallel_for(tbb::blocked_range<int>(0, camera.height, 1), [&](const tbb::blocked_range<int>& rows) {
    std::vector<Medium::Step> steps;
    Errors& error = errors.local();
    for (int y = rows.begin(); y < rows.end(); ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const float* surface = surfaces.radiance.at(x, y);
        MediumLight light;
        bool inside_volume = false;
        if (medium) {
          const Ray ray{eye, camera.ray_direction(x + 0.5, y + 0.5)};
          const double near_m = static_cast<double>(camera.view.near_m) / glm::dot(ray.direction, forward);
          const double surface_m =
              surfaces.distance_m[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)];
          const Interval inside = medium->grid().clip(ray.origin, ray.direction, {near_m, surface_m});
          inside_volume = inside.end > inside.begin;
          if (inside_volume) light = medium->along(ray, inside, options, steps);
        }
        float* pixel = result.image.at(x, y);
        double pixel_error = 0.0;
        for (int c = 0; c < 3; ++c) {
          const double radiance = light.radiance[c] + light.transmittance * static_cast<double>(surface[c]);
          pixel[c] = static_cast<float>(radiance);
          pixel_error = std::max(pixel_error, std::abs(static_cast<double>(pixel[c]) - radiance));
        }
        pixel[3] = static_cast<float>(light.transmittance);
        *result.mask.at(x, y) = inside_volume ? 1.0F : 0.0F;
        // What remains when the steps are exact is the rounding to the image's 32 bits.
        pixel_error += light.step_error;
        error.max = std::max(error.max, pixel_error);
        error.sum += pixel_error;
        error.unconverged += light.converged ? 0 : 1;
      }
      if (options.progress) options.progress(static_cast<double>(++rows_done) / static_cast<double>(height));
    }
  });

  const Errors total = errors.combine([](const Errors& a, const Errors& b) {
    return Errors{std::max(a.max, b.max), a.sum + b.sum, a.unconverged + b.unconverged};
  });
  const auto pixels = static_cast<double>(width * height);
  result.step_error_max = total.max;
  result.step_error_mean = total.sum / pixels;
  result.unconverged_share = static_cast<double>(total.unconverged) / pixels;
  return result;
}

}  // namespace pellucid
