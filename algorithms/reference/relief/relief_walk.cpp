// Light in a relief's medium that scatters, by random walks.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "algorithms/reference/media/phase.hpp"
#include "algorithms/reference/relief/relief_tracer.hpp"
#include "algorithms/scattering/slab.hpp"
#include "algorithms/shaders/optics.hpp"

namespace pellucid {
namespace {

constexpr int kMostEvents = 100'000;
constexpr double kUnbounded = std::numeric_limits<double>::infinity();

// How light of three channels fared over distances that are drawn for one of them: the media transmit `left` of it, and
// the distances are as likely as `likelihood`, times one factor. No weight grows beyond 3.
struct Spectrum {
  glm::dvec3 left{1.0}, likelihood{1.0};

  void go(const glm::dvec3& left_by, const glm::dvec3& likelihood_by, int drawn) {
    left *= left_by;
    likelihood *= likelihood_by;
    const double scale = 1.0 / likelihood[drawn];
    left *= scale;
    likelihood *= scale;
  }
  glm::dvec3 weight() const { return left * (3.0 / (likelihood.x + likelihood.y + likelihood.z)); }
};

}  // namespace

glm::dvec3 ReliefTracer::walk(const ReliefPlace& place, glm::dvec3 p, glm::dvec3 direction, const Visible& visible,
                              const Objects& objects, Random& random) const {
  const glm::dvec3 scatters(relief_->scattering), extinction = scatters + glm::dvec3(relief_->absorption);
  const double g = static_cast<double>(relief_->anisotropy);
  const double eta = static_cast<double>(relief_->index) / static_cast<double>(relief_->outside_index);
  const auto uniform = [&] { return static_cast<double>(random.next()); };
  const int drawn = random.below(3);
  Spectrum spectrum;
  glm::dvec3 sum(0.0), weight(1.0);
  bool scattered = false, bounced = false;
  for (int event = 0; event < kMostEvents; ++event) {
    const ReliefRay ray = place.ray(p, direction);
    const double floor = meet(solid_, ray, 0.0, 1.0).value_or(kUnbounded);
    const double leaves = meet(*medium_, ray, 0.0, -1.0).value_or(kUnbounded);
    double end = std::min(floor, leaves);
    if (end == kUnbounded) end = end_of(ray, 0.0);
    const auto object =
        objects ? objects(place.position + place.to_world(p), place.to_world(direction), end) : std::optional<Object>();
    if (object) end = object->distance_m;

    const double s = extinction[drawn] > 0 ? -std::log(1 - uniform()) / extinction[drawn] : kUnbounded;
    if (s < end) {
      const glm::dvec3 t = glm::exp(-extinction * s);
      spectrum.go(scatters * t, extinction * t, drawn);
      p = ray.at(s);
      scattered = true;
      for (std::size_t i = 0; i < light_->light_count(); ++i) {
        const Incidence in = light_->incidence(i, place.position + place.to_world(p));
        const glm::dvec3 to_light = place.to_frame(in.to_light);
        const Arriving light = arriving(place, p, to_light, -1.0);
        if (light.share == glm::dvec3(0.0)) continue;
        sum += weight * spectrum.weight() * in.irradiance * light.share *
               (scattering::henyey_greenstein(glm::dot(direction, light.direction), g) *
                this->visible(place, visible, i, p, to_light, in.distance));
      }
      direction = deflected(direction, g, random);
    } else {
      const glm::dvec3 t = glm::exp(-extinction * end);
      spectrum.go(t, t, drawn);
      const glm::dvec3 seen = weight * spectrum.weight();
      if (object) return sum + (bounced ? glm::dvec3(0.0) : seen * object->radiance);
      if (!scattered && !bounced && leaves <= floor) {  // as where nothing scatters: straight on
        return sum + seen * (floor < kUnbounded ? solid_radiance(place, ray.at(floor), direction, visible)
                                                : environment(place, direction));
      }
      p = ray.at(end);
      if (floor <= leaves && floor < kUnbounded) {
        if (bounced) return sum;
        sum += seen * solid_radiance(place, p, direction, visible);
        const glm::dvec2 uv = ray.uv_at(end);
        if (!(medium_->height_m(uv) > p.z)) return sum;
        bounced = true;
        weight *= solid_albedo(place, uv);
        direction = direction_about(solid_.normal(uv, ray.uv_per_metre), std::sqrt(1 - uniform()), uniform());
      } else {
        // The ambient light is all that shines in from outside; on what it adds to the solid, solid_radiance() has it.
        const glm::dvec3 outside = bounced ? glm::dvec3(0.0) : seen * light_->ambient();
        if (leaves == kUnbounded) return sum + outside;
        const glm::dvec3 n = medium_->normal(ray.uv_at(end), ray.uv_per_metre);
        const double cosine = glm::dot(direction, n);
        if (uniform() >= fresnel_dielectric(std::abs(cosine), eta)) return sum + outside;
        direction = glm::normalize(direction - 2.0 * cosine * n);
      }
    }
    // Walks of little weight end by chance, and the others weigh more for it.
    constexpr double kLow = 0.1;
    const glm::dvec3 light = weight * spectrum.weight();
    const double most = std::max({light.x, light.y, light.z});
    if (most < kLow) {
      if (uniform() >= most / kLow) return sum;
      weight *= kLow / most;
    }
  }
  return sum;
}

}  // namespace pellucid
