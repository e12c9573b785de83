#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <optional>

#include <tbb/blocked_range.h>
#include <tbb/combinable.h>
#include <tbb/parallel_for.h>

#include "algorithms/reference/media/scattering.hpp"
#include "algorithms/reference/reference.hpp"

namespace pellucid {
namespace {

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
  std::optional<Scattering> medium;
  if (scene.volume)
    medium.emplace(scene, *scene.volume);
  else if (!surfaces.optical.pixels.empty())
    result.mask = surfaces.optical;
  result.surfaces = surfaces.statistics;
  const glm::dvec3 eye(camera.view.eye);
  const glm::dvec3 forward = glm::normalize(glm::dvec3(camera.view.target) - eye);
  tbb::combinable<Errors> errors;
  std::atomic<int> rows_done{0};

  tbb::parallel_for(tbb::blocked_range<int>(0, camera.height, 1), [&](const tbb::blocked_range<int>& rows) {
    Scattering::Scratch scratch;
    Errors& error = errors.local();
    for (int y = rows.begin(); y < rows.end(); ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const float* surface = surfaces.radiance.at(x, y);
        ScatteredLight light;
        bool inside_volume = false;
        if (medium) {
          const glm::dvec3 direction = camera.ray_direction(x + 0.5, y + 0.5);
          const double near_m = static_cast<double>(camera.view.near_m) / glm::dot(direction, forward);
          const double surface_m =
              surfaces.distance_m[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)];
          const Interval inside = medium->grid().clip(eye, direction, {near_m, surface_m});
          inside_volume = inside.end > inside.begin;
          if (inside_volume) light = medium->along(eye, direction, inside, options, scratch);
        }
        float* pixel = result.image.at(x, y);
        double pixel_error = 0.0;
        for (int c = 0; c < 3; ++c) {
          const double radiance = light.radiance[c] + light.transmittance * static_cast<double>(surface[c]);
          pixel[c] = static_cast<float>(radiance);
          pixel_error = std::max(pixel_error, std::abs(static_cast<double>(pixel[c]) - radiance));
        }
        pixel[3] = static_cast<float>(light.transmittance);
        if (medium) *result.mask.at(x, y) = inside_volume ? 1.0F : 0.0F;
        // When the steps are exact, the rest is the rounding to the image's 32 bits.
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
