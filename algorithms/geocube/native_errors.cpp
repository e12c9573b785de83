#include "algorithms/geocube/native_errors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <nlohmann/json.hpp>

#include "algorithms/optics.hpp"

namespace pellucid::geocube {
namespace {

constexpr double kEarly = 0.01;

glm::dvec3 xyz(const float* p) {
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

void summarise(std::vector<double>& values, const std::string& name, nlohmann::json& out) {
  if (values.empty()) return;
  std::sort(values.begin(), values.end());
  double sum = 0;
  for (const double v : values)
    sum += v;
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  };
  out[name + "_mean"] = sum / static_cast<double>(values.size());
  out[name + "_median"] = at(0.5);
  out[name + "_q95"] = at(0.95);
  out[name + "_max"] = values.back();
}

}  // namespace

void SearchErrors::add(const SearchReport& report, const Solid& solid, double ior) {
  const double diagonal = solid.diagonal();
  for (std::size_t i = 0; i < report.entry.size(); i += 4) {
    if (report.entry[i + 3] < 0.5F) continue;
    const glm::dvec3 p = xyz(&report.entry[i]), h = glm::normalize(xyz(&report.ray[i]));
    // From just beneath the surface: the entry lies on it to single precision.
    const auto truth = solid.first_hit(p, h, 2e-5 * diagonal);
    if (!truth || !truth->leaves) continue;  // grazes out at once
    const glm::dvec3 exit = xyz(&report.exit_point[i]);
    const double length = std::abs(static_cast<double>(report.exit_point[i + 3]));
    exit_.push_back(glm::distance(exit, p + truth->distance * h) / diagonal);
    length_.push_back(std::abs(length - truth->distance) / diagonal);
    early_ += length < truth->distance - kEarly * diagonal;
    bounded_ += report.exit_point[i + 3] < 0;
    const double steps = static_cast<double>(report.ray[i + 3]);
    steps_ += steps;
    most_steps_ = std::max(most_steps_, steps);
    const glm::dvec3 found_normal = xyz(&report.exit_normal[i]);
    if (glm::dot(found_normal, h) <= 0) continue;
    const auto ours = refracted(h, -found_normal, ior);
    const auto theirs = refracted(h, -solid.shading_normal(truth->triangle, truth->weights), ior);
    if (!ours || !theirs) continue;
    const double angle = std::atan2(glm::length(glm::cross(*ours, *theirs)), glm::dot(*ours, *theirs));
    direction_deg_.push_back(angle * 180 / std::numbers::pi);
  }
}

void SearchErrors::write(nlohmann::json& out) {
  if (exit_.empty()) return;
  const auto count = static_cast<double>(exit_.size());
  out["object_pixels"] = exit_.size();
  summarise(exit_, "exit_error", out);
  summarise(length_, "length_error", out);
  summarise(direction_deg_, "exit_direction_error_deg", out);
  out["early_share"] = static_cast<double>(early_) / count;
  out["bounded_share"] = static_cast<double>(bounded_) / count;
  out["steps_mean"] = steps_ / count;
  out["steps_max"] = most_steps_;
}

}  // namespace pellucid::geocube
