#include "algorithms/translucent_relief/native_errors.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include <nlohmann/json.hpp>
#include <tbb/parallel_for.h>

#include "algorithms/raster/native_map.hpp"

namespace pellucid::translucent_relief {
namespace {

// The maps, in their order.
enum : std::size_t { kHit, kMissed, kOcclusion, kTaken, kCovered };

glm::dvec3 xyz(const float* p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

double worst(const glm::dvec3& v) {
  return std::max({v.x, v.y, v.z});
}

}  // namespace

SearchErrors::SearchErrors(int width, int height) {
  const auto add = [&](const char* name, const char* unit, const char* doc) {
    maps_.push_back(make_native_map(name, unit, doc, width, height));
  };
  add("first_hit_error_m", "m",
      "distance along the view ray between the first hit and the true one, where none is missed");
  add("missed", "", "1 where the view ray stepped through what it meets first");
  add("occlusion_error", "of the light", "difference between the first light's share at the hit and the true one");
  add("heights_taken", "heights", "heights that the view ray asked for");
  add("covered", "", "1 where the view ray meets the medium before the solid");
}

void SearchErrors::add(const SearchReport& report, const ReliefTracer& tracer) {
  assert(report.start.size() == 4 * maps_[kHit].values.pixels.size());
  tbb::parallel_for(std::size_t{0}, report.start.size() / 4, [&](std::size_t pixel) {
    const std::size_t i = 4 * pixel;
    const float* scale = &report.scale[i];
    if (scale[3] < 0.5F) return;
    ReliefPlace place;
    place.frame.metres_per_u = static_cast<double>(scale[0]);
    place.frame.metres_per_v = static_cast<double>(scale[1]);
    place.uv = {static_cast<double>(report.start[i]), static_cast<double>(report.start[i + 1])};
    const glm::dvec3 v = glm::normalize(xyz(&report.ray[i]));
    const double step_m = static_cast<double>(report.ray[i + 3]);
    const double found = static_cast<double>(report.start[i + 3]);
    const bool met = report.start[i + 2] > 0.5F;
    const auto truth = tracer.first_hit(place, v);
    const auto put = [&](std::size_t map, double value) { gl_pixel(maps_[map], pixel) = static_cast<float>(value); };
    if (!truth && !met) return;
    put(kTaken, static_cast<double>(scale[2]));
    if (truth) put(kCovered, truth->medium ? 1 : 0);
    // A ray that leaves through the side just where it would meet something is decided by a rounding.
    const bool missed = truth && (!met || found > truth->distance_m + step_m);
    put(kMissed, missed ? 1 : 0);
    if (missed || !truth) return;
    put(kHit, std::abs(found - truth->distance_m));
    if (tracer.scatters()) return;  // the tracer tells the share of unscattered light alone
    const glm::dvec3 to_light = xyz(&report.light[i]);
    if (glm::length(to_light) < 0.5 || to_light.z <= 0.0) return;
    const glm::dvec3 share = tracer.light_reaching(place, truth->distance_m * v, glm::normalize(to_light), 1.0);
    put(kOcclusion, std::abs(static_cast<double>(report.light[i + 3]) - worst(share)));
  });
}

void SearchErrors::write(nlohmann::json& out) const {
  const std::vector<float>& missed = maps_[kMissed].values.pixels;
  const auto pixels = std::count_if(missed.begin(), missed.end(), [](float v) { return std::isfinite(v); });
  if (pixels == 0) return;
  out["relief_pixels"] = pixels;
  for (const NativeMap& map : maps_)
    summarise(map, out);
}

}  // namespace pellucid::translucent_relief
