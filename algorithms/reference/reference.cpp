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

// ∫ σ C T dt over the spans with three-point Gauss–Legendre quadrature on `parts` equal parts of each.
template <class Source>
glm::dvec3 integrate(const std::vector<CellSpan>& spans, int parts, Source source) {
  static const double offset = std::sqrt(0.15);
  const std::array<double, 3> nodes = {0.5 - offset, 0.5, 0.5 + offset};
  constexpr std::array<double, 3> kWeights = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  glm::dvec3 sum(0.0);
  double depth = 0.0;  // τ up to the span
  for (const CellSpan& span : spans) {
    for (int part = 0; part < parts; ++part) {
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        const double s = (part + nodes[i]) / parts;
        const double weight = kWeights[i] * span.length_m / parts * span.sigma(s) * std::exp(-depth - span.depth(s));
        sum += weight * source(span.begin_m + s * span.length_m);
      }
    }
    depth += span.depth(1.0);
  }
  return sum;
}

// The medium of a scene, ready for rays.
class Medium {
 public:
  Medium(const Scene& scene, const Volume& volume)
      : scene_(&scene),
        grid_(volume),
        albedo_(volume.albedo),
        emission_(volume.emission),
        uniform_(uniform_source(scene)) {
    if (uniform_) source_ = medium_radiance(scene, glm::dvec3(0.0), albedo_, emission_);
  }

  const MediumGrid& grid() const { return grid_; }

  MediumLight light(const Ray& ray, const Interval& inside, const ReferenceOptions& options,
                    std::vector<CellSpan>& spans) const {
    MediumLight result;
    if (uniform_) {
      // A constant C leaves ∫ C dT: exact, since the optical depth is.
      const double depth = grid_.optical_depth(ray.origin, ray.direction, inside);
      result.transmittance = std::exp(-depth);
      result.radiance = -std::expm1(-depth) * source_;
      return result;
    }
    spans.clear();
    grid_.trace(ray.origin, ray.direction, inside, spans);
    if (spans.empty()) return result;
    double depth = 0.0;
    for (const CellSpan& span : spans)
      depth += span.depth(1.0);
    result.transmittance = std::exp(-depth);

    const auto source = [&](double t) {
      return medium_radiance(*scene_, ray.origin + t * ray.direction, albedo_, emission_);
    };
    const auto count = static_cast<double>(spans.size());
    int parts = std::max(1, static_cast<int>(std::ceil(options.min_steps / count)));
    result.radiance = integrate(spans, parts, source);
    do {
      parts *= 2;
      const glm::dvec3 finer = integrate(spans, parts, source);
      result.step_error = largest(glm::abs(finer - result.radiance));
      result.radiance = finer;
      result.converged = result.step_error < options.tolerance;
    } while (!result.converged && 2.0 * parts * count <= options.max_steps);
    return result;
  }

 private:
  const Scene* scene_;
  MediumGrid grid_;
  glm::dvec3 albedo_, emission_;
  bool uniform_;
  glm::dvec3 source_{0.0};
};

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
    std::vector<CellSpan> spans;
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
          if (inside_volume) light = medium->light(ray, inside, options, spans);
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
