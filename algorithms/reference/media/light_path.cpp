#include "algorithms/reference/media/light_path.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace pellucid {
namespace {

// Cuts closer than this share of the ray's part are one.
constexpr double kGap = 1e-12;
// The grading towards a light that stands on the ray ends at this share of the ray's part.
constexpr double kNearest = 1e-6;

}  // namespace

LightPath::LightPath(const Scene& scene, const Volume& volume, const Illumination& light) : light_(&light) {
  assert(scene.lights.size() == light.light_count() && light.light_count() <= 32);
  if (volume.light >= 0) only_ = static_cast<std::size_t>(volume.light);
  for (std::size_t i = 0; i < light.light_count(); ++i) {
    if (light.casts_shadow(i) && (!only_ || *only_ == i) && !shadows_) shadows_.emplace(scene);
  }
}

bool LightPath::plain() const {
  return !shadows_ && !only_ && light_->uniform();
}

// Where the ray crosses the double cone of all directions at an angle of that cosine to the light's axis.
void LightPath::cut_cone(const Emitter& light, double cosine, const Ray& ray, const Interval& part,
                         std::vector<double>& cuts) const {
  // ((x − P)·D)² = cos² (x − P)², that is a t² + 2 b t + c = 0.
  const glm::dvec3 from_light = ray.origin - light.position;
  const double m = glm::dot(ray.direction, light.direction), q = glm::dot(from_light, light.direction);
  const double cosine2 = cosine * cosine;
  const double a = m * m - cosine2, b = q * m - cosine2 * glm::dot(from_light, ray.direction);
  const double c = q * q - cosine2 * glm::dot(from_light, from_light);
  const double square = b * b - a * c;
  if (!(square > 0.0)) return;
  const double sum = -(b + std::copysign(std::sqrt(square), b));
  for (const double t : {sum / a, c / sum}) {
    if (t > part.begin && t < part.end) cuts.push_back(t);
  }
}

// The parts on which a spot gives light, shadows aside.
void LightPath::find_in_cone(const Emitter& light, const Ray& ray, const Interval& inside,
                             std::vector<Interval>& parts) const {
  std::vector<double> cuts;
  cut_cone(light, light.cos_outer, ray, inside, cuts);
  std::sort(cuts.begin(), cuts.end());
  cuts.push_back(inside.end);
  double begin = inside.begin;
  for (const double end : cuts) {
    const glm::dvec3 from_light = ray.origin + 0.5 * (begin + end) * ray.direction - light.position;
    if (glm::dot(from_light, light.direction) > light.cos_outer * glm::length(from_light))
      parts.push_back({begin, end});
    begin = end;
  }
}

void LightPath::find_lit(std::size_t index, const Ray& ray, const Interval& inside, Scratch& scratch) const {
  const Emitter& light = light_->lights()[index];
  std::vector<Interval>& lit = scratch.lit[index];
  scratch.in_cone.clear();
  if (light.kind == LightKind::spot && !only_) {
    find_in_cone(light, ray, inside, scratch.in_cone);
  } else {
    scratch.in_cone.push_back(inside);
  }
  if (!light.casts_shadow) {
    lit = scratch.in_cone;
    return;
  }
  const glm::dvec4 place =
      light.kind == LightKind::directional ? glm::dvec4(-light.direction, 0.0) : glm::dvec4(light.position, 1.0);
  for (const Interval& part : scratch.in_cone) {
    scratch.shadows.clear();
    shadows_->find(ray.origin, ray.direction, part, place, scratch.shadows);
    double begin = part.begin;
    for (const Interval& shadow : scratch.shadows) {
      if (shadow.begin > begin) lit.push_back({begin, shadow.begin});
      begin = shadow.end;
    }
    if (part.end > begin) lit.push_back({begin, part.end});
  }
}

// Parts of twice the size, and at twice the distance from the light, one after the other.
void LightPath::grade(const Emitter& light, const Ray& ray, const Interval& part, std::vector<double>& cuts) const {
  const glm::dvec3 from_light = ray.origin - light.position;
  const double nearest = -glm::dot(from_light, ray.direction);
  const double length = part.end - part.begin;
  const double distance = std::max(glm::length(from_light + nearest * ray.direction), kNearest * length);
  const auto add = [&](double t) {
    if (t > part.begin && t < part.end) cuts.push_back(t);
  };
  add(nearest);
  const double farthest = std::max(std::abs(part.begin - nearest), std::abs(part.end - nearest));
  for (double step = distance; step < farthest; step *= 2.0) {
    add(nearest - step);
    add(nearest + step);
  }
}

void LightPath::find(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& inside, Scratch& scratch,
                     std::vector<LitPart>& parts) const {
  const Ray ray{origin, direction};
  scratch.lit.resize(light_->light_count());
  scratch.cuts.clear();
  for (std::size_t i = 0; i < scratch.lit.size(); ++i) {
    scratch.lit[i].clear();
    if (only_ && *only_ != i) continue;
    find_lit(i, ray, inside, scratch);
    const Emitter& light = light_->lights()[i];
    for (const Interval& part : scratch.lit[i]) {
      scratch.cuts.push_back(part.begin);
      scratch.cuts.push_back(part.end);
      if (only_) continue;
      if (light.kind == LightKind::spot) cut_cone(light, light.cos_inner, ray, part, scratch.cuts);
      if (light.kind != LightKind::directional) grade(light, ray, part, scratch.cuts);
    }
  }
  std::sort(scratch.cuts.begin(), scratch.cuts.end());
  scratch.cuts.push_back(inside.end);

  parts.clear();
  const double gap = kGap * (inside.end - inside.begin);
  double begin = inside.begin;
  for (const double end : scratch.cuts) {
    if (end - begin <= gap && end < inside.end) continue;
    LitPart part{end, 0};
    const double middle = 0.5 * (begin + end);
    for (std::size_t i = 0; i < scratch.lit.size(); ++i) {
      const std::vector<Interval>& lit = scratch.lit[i];
      const auto at =
          std::partition_point(lit.begin(), lit.end(), [&](const Interval& interval) { return interval.end < middle; });
      if (at != lit.end() && at->begin <= middle) part.lights |= 1U << i;
    }
    // A part that differs in nothing but where it ends still keeps its cut: it may be a graded one.
    parts.push_back(part);
    begin = end;
    if (begin >= inside.end) break;
  }
}

}  // namespace pellucid
