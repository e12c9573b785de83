#include "algorithms/reference/relief/relief_tracer.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "algorithms/shaders/optics.hpp"

namespace pellucid {
namespace {

constexpr int kMostBoundaries = 64;

// A normal that looks away from the ray, as interpolated ones may, is turned so far that the ray grazes.
glm::dvec3 facing(const glm::dvec3& n, const glm::dvec3& v) {
  const double along = glm::dot(n, v);
  return along < 0.0 ? n : glm::normalize(n - 1.0001 * along * v);
}

// Phong's highlight, relative to a white Lambertian surface's radiance in light along its normal.
double phong(const ReliefLayer& layer, const glm::dvec3& reflected, const glm::dvec3& to_light) {
  if (layer.specular <= 0.0F) return 0.0;
  return static_cast<double>(layer.specular) *
         std::pow(std::max(glm::dot(reflected, to_light), 0.0), static_cast<double>(layer.exponent));
}

}  // namespace

ReliefTracer::ReliefTracer(const Scene& scene, int relief, const Illumination& light, const ReliefOptics& optics)
    : scene_(&scene),
      relief_(&scene.reliefs[static_cast<std::size_t>(relief)]),
      light_(&light),
      optics_(optics),
      solid_(relief_->solid, glm::dvec2(relief_->tiling)) {
  if (relief_->translucent) medium_.emplace(*relief_->translucent, glm::dvec2(relief_->tiling));
}

std::optional<double> ReliefTracer::meet(const HeightField& field, const ReliefRay& ray, double from,
                                         double side) const {
  // A little more than the heights take, so that the lowest and the highest of them are found.
  const double margin = 1e-6 * (field.high_m() - field.low_m());
  const auto range = clip(ray, field.low_m() - margin, field.high_m() + margin, relief_->cut, from);
  return range ? field.crossing(ray, range->x, range->y, side) : std::nullopt;
}

// Where the ray leaves the layers' box.
double ReliefTracer::end_of(const ReliefRay& ray, double from) const {
  const auto range =
      clip(ray, static_cast<double>(relief_->low_m()), static_cast<double>(relief_->high_m()), relief_->cut, from);
  return range ? range->y : from;
}

std::optional<ReliefHit> ReliefTracer::first_hit(const ReliefPlace& place, const glm::dvec3& direction) const {
  const ReliefRay ray = place.ray(glm::dvec3(0.0), direction);
  const auto solid = meet(solid_, ray, 0.0, 1.0);
  const auto medium = medium_ ? meet(*medium_, ray, 0.0, 1.0) : std::nullopt;
  if (medium && (!solid || *medium < *solid)) return ReliefHit{*medium, true};
  if (solid) return ReliefHit{*solid, false};
  return std::nullopt;
}

ReliefTracer::Arriving ReliefTracer::arriving(const ReliefPlace& place, const glm::dvec3& p, const glm::dvec3& to_light,
                                              double side) const {
  Arriving result;
  result.direction = to_light;
  if (to_light.z <= 0.0) return result;
  const double n1 = static_cast<double>(relief_->outside_index), n2 = static_cast<double>(relief_->index);
  const bool bend = optics_.refract_light && side < 0.0 && medium_;
  if (bend) {
    // The direction inside that the surface bends towards the light: by repeated substitution from a level surface.
    glm::dvec3 n(0.0, 0.0, 1.0);
    for (int i = 0; i < 16; ++i) {
      const auto inside = refracted(-to_light, n, n1 / n2);
      if (!inside) return result;
      result.direction = -*inside;
      const ReliefRay ray = place.ray(p, result.direction);
      const auto out = meet(*medium_, ray, 0.0, -1.0);
      if (!out) break;
      const glm::dvec3 next = facing(medium_->normal(ray.uv_at(*out), ray.uv_per_metre), -to_light);
      const bool settled = glm::distance(next, n) < 1e-9;
      n = next;
      if (settled) break;
    }
    // The beam is as much narrower inside as it is bent: its power goes through the same part of the surface.
    result.share = glm::dvec3(glm::dot(to_light, n) / std::max(glm::dot(result.direction, n), 1e-6));
  } else {
    result.share = glm::dvec3(1.0);
  }

  ReliefRay ray = place.ray(p, result.direction);
  double from = 0.0, inside = 0.0, share = 1.0, solid_from = 0.0;
  bool bent = !bend;
  for (int i = 0; medium_ && i < kMostBoundaries; ++i) {
    const auto boundary = meet(*medium_, ray, from, side);
    if (!boundary) break;
    const glm::dvec3 n = medium_->normal(ray.uv_at(*boundary), ray.uv_per_metre);
    const glm::dvec3 outside = bent ? ray.direction : to_light;
    const double cosine = std::abs(glm::dot(outside, n));
    share *= 1.0 - fresnel_dielectric(cosine, side < 0.0 ? n1 / n2 : n2 / n1);
    if (side < 0.0) inside += *boundary - from;
    from = *boundary;
    side = -side;
    if (!bent) {  // from here on it goes to the light
      if (meet(solid_, ray, 0.0, 1.0).value_or(from) < from) return Arriving{glm::dvec3(0.0), result.direction};
      bent = true;
      ray = place.ray(ray.at(from), to_light);
      from = 0.0;
      solid_from = 0.0;
    }
  }
  if (meet(solid_, ray, solid_from, 1.0)) return Arriving{glm::dvec3(0.0), result.direction};
  if (side < 0.0) inside += std::max(end_of(ray, from) - from, 0.0);
  result.share *= share * transmitted(glm::dvec3(relief_->absorption) + glm::dvec3(relief_->scattering), inside);
  return result;
}

glm::dvec3 ReliefTracer::light_reaching(const ReliefPlace& place, const glm::dvec3& p, const glm::dvec3& to_light,
                                        double side) const {
  return arriving(place, p, to_light, side).share;
}

// At the place where the light comes through the mesh.
double ReliefTracer::visible(const ReliefPlace& place, const Visible& visible, std::size_t light, const glm::dvec3& p,
                             const glm::dvec3& to_light, double distance_m) const {
  if (!light_->casts_shadow(light) || to_light.z <= 0.0) return 1.0;
  const double up = -p.z / to_light.z;
  const glm::dvec3 through = place.position + place.to_world(p + up * to_light);
  return visible(light, through, place.to_world(to_light), distance_m - up) ? 1.0 : 0.0;
}

glm::dvec3 ReliefTracer::environment(const ReliefPlace& place, const glm::dvec3& direction) const {
  return glm::dvec3(scene_->environment.radiance(glm::vec3(place.to_world(direction))));
}

glm::dvec3 ReliefTracer::solid_albedo(const ReliefPlace& place, const glm::dvec2& uv) const {
  return glm::dvec3(relief_->solid.albedo) * place.tint * solid_.color(uv);
}

glm::dvec3 ReliefTracer::solid_radiance(const ReliefPlace& place, const glm::dvec3& p, const glm::dvec3& v,
                                        const Visible& visible) const {
  const ReliefRay here = place.ray(p, v);
  const glm::dvec2 uv = here.uv_at(0.0);
  const glm::dvec3 n = solid_.normal(uv, here.uv_per_metre);
  const glm::dvec3 albedo = solid_albedo(place, uv);
  const double side = medium_ && medium_->height_m(uv) > p.z ? -1.0 : 1.0;
  glm::dvec3 sum = albedo * light_->ambient();
  for (std::size_t i = 0; i < light_->light_count(); ++i) {
    const Incidence in = light_->incidence(i, place.position + place.to_world(p));
    const glm::dvec3 to_light = place.to_frame(in.to_light);
    const Arriving light = arriving(place, p, to_light, side);
    const double cosine = glm::dot(n, light.direction);
    if (cosine <= 0.0 || light.share == glm::dvec3(0.0)) continue;
    const glm::dvec3 answer = albedo * cosine + phong(relief_->solid, reflected(v, n), light.direction);
    sum += in.irradiance / std::numbers::pi * light.share * answer *
           this->visible(place, visible, i, p, to_light, in.distance);
  }
  return sum;
}

glm::dvec3 ReliefTracer::radiance(const ReliefPlace& place, const glm::dvec3& v, const ReliefHit& hit,
                                  const Visible& visible, const Objects& objects, Random* random) const {
  const glm::dvec3 p = hit.distance_m * v;
  if (!hit.medium) return solid_radiance(place, p, v, visible);

  const ReliefRay arriving_ray = place.ray(p, v);
  const glm::dvec3 n = facing(medium_->normal(arriving_ray.uv_at(0.0), arriving_ray.uv_per_metre), v);
  const double eta = static_cast<double>(relief_->outside_index) / static_cast<double>(relief_->index);
  const double cosine = std::min(-glm::dot(v, n), 1.0);
  const double reflected_share = fresnel_dielectric(cosine, eta);
  glm::dvec3 sum(0.0);
  // The radiance that a ray shows from here on, and how far away that is.
  const auto seen = [&](const glm::dvec3& direction, double free_m) {
    const ReliefRay ray = place.ray(p, direction);
    const auto solid = meet(solid_, ray, 0.0, 1.0);
    if (objects) {
      if (const auto object =
              objects(place.position + place.to_world(p), place.to_world(direction), solid.value_or(free_m)))
        return *object;
    }
    if (solid) return Object{*solid, solid_radiance(place, ray.at(*solid), direction, visible)};
    return Object{end_of(ray, 0.0), environment(place, direction)};
  };
  const auto bent = refracted(v, n, eta);
  if (bent && reflected_share < 1.0 && relief_->scatters()) {
    assert(random != nullptr);
    sum += (1.0 - reflected_share) * walk(place, p, *bent, visible, objects, *random);
  } else if (bent && reflected_share < 1.0) {
    const ReliefRay ray = place.ray(p, *bent);
    const Object far = seen(*bent, end_of(ray, 0.0));
    const double inside = std::min(far.distance_m, meet(*medium_, ray, 0.0, -1.0).value_or(far.distance_m));
    sum += (1.0 - reflected_share) * transmitted(glm::dvec3(relief_->absorption), inside) * far.radiance;
  }
  const glm::dvec3 mirrored = reflected(v, n);
  sum += reflected_share * seen(mirrored, std::numeric_limits<double>::infinity()).radiance;

  for (std::size_t i = 0; i < light_->light_count(); ++i) {
    const Incidence in = light_->incidence(i, place.position + place.to_world(p));
    const glm::dvec3 to_light = place.to_frame(in.to_light);
    const double highlight = phong(*relief_->translucent, mirrored, to_light);
    if (highlight < 1e-4 || glm::dot(n, to_light) <= 0.0) continue;
    sum += glm::mix(reflected_share, 1.0, static_cast<double>(relief_->intensification)) * highlight * in.irradiance /
           std::numbers::pi * arriving(place, p, to_light, 1.0).share *
           this->visible(place, visible, i, p, to_light, in.distance);
  }
  return sum;
}

}  // namespace pellucid
