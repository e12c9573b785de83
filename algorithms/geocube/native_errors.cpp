#include "algorithms/geocube/native_errors.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <nlohmann/json.hpp>

#include "algorithms/raster/native_map.hpp"
#include "algorithms/shaders/optics.hpp"

namespace pellucid::geocube {
namespace {

constexpr double kEarly = 0.01;

// The maps, in their order.
enum : std::size_t { kExit, kLength, kDirection, kSteps, kEndsEarly, kBounded };

glm::dvec3 xyz(const float* p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

}  // namespace

SearchErrors::SearchErrors(int width, int height) {
  const auto add = [&](const char* name, const char* unit, const char* doc) {
    maps_.push_back(make_native_map(name, unit, doc, width, height));
  };
  add("exit_error", "diagonals", "distance of the exit point from the true one");
  add("length_error", "diagonals", "difference between the way's length inside and the true one, absolute");
  add("exit_direction_error_deg", "deg", "angle between the leaving light and the true one, where both leave");
  add("steps", "steps", "steps of the first search");
  add("early", "", "1 where the ray ends more than 1 % of the diagonal before the surface");
  add("bounded", "", "1 where the bound stopped the search");
}

void SearchErrors::add(const SearchReport& report, const Solid& solid, double ior) {
  const double diagonal = solid.diagonal();
  assert(report.entry.size() == 4 * maps_[kExit].values.pixels.size());
  for (std::size_t i = 0; i < report.entry.size(); i += 4) {
    if (report.entry[i + 3] < 0.5F) continue;
    const glm::dvec3 p = xyz(&report.entry[i]), h = glm::normalize(xyz(&report.ray[i]));
    // From just beneath the surface: the entry lies on it to single precision.
    const auto truth = solid.first_hit(p, h, 2e-5 * diagonal);
    if (!truth || !truth->leaves) continue;  // grazes out at once
    const auto put = [&](std::size_t map, double value) { gl_pixel(maps_[map], i / 4) = static_cast<float>(value); };
    const glm::dvec3 exit = xyz(&report.exit_point[i]);
    const double length = std::abs(static_cast<double>(report.exit_point[i + 3]));
    put(kExit, glm::distance(exit, p + truth->distance * h) / diagonal);
    put(kLength, std::abs(length - truth->distance) / diagonal);
    put(kSteps, static_cast<double>(report.ray[i + 3]));
    put(kEndsEarly, length < truth->distance - kEarly * diagonal ? 1 : 0);
    put(kBounded, report.exit_point[i + 3] < 0 ? 1 : 0);
    const glm::dvec3 found_normal = xyz(&report.exit_normal[i]);
    if (glm::dot(found_normal, h) <= 0) continue;
    const auto ours = refracted(h, -found_normal, ior);
    const auto theirs = refracted(h, -solid.shading_normal(truth->triangle, truth->weights), ior);
    if (!ours || !theirs) continue;
    const double angle = std::atan2(glm::length(glm::cross(*ours, *theirs)), glm::dot(*ours, *theirs));
    put(kDirection, angle * 180 / std::numbers::pi);
  }
}

void SearchErrors::write(nlohmann::json& out) const {
  const std::vector<float>& exits = maps_[kExit].values.pixels;
  const auto pixels = std::count_if(exits.begin(), exits.end(), [](float v) { return std::isfinite(v); });
  if (pixels == 0) return;
  out["object_pixels"] = pixels;
  for (const NativeMap& map : maps_)
    summarise(map, out);
}

}  // namespace pellucid::geocube
