#include "algorithms/reference/relief/relief_surfaces.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <limits>

#include <fmt/format.h>

#include "algorithms/reference/relief/relief_air.hpp"
#include "gl/error.hpp"

namespace pellucid {
namespace {

constexpr double kAirSteps = 400;

template <class Value>
auto interpolate(const std::vector<Value>& values, const Hit& hit) {
  using Double = glm::vec<Value::length(), double>;
  return hit.weights.x * Double(values[hit.triangle.x]) + hit.weights.y * Double(values[hit.triangle.y]) +
         hit.weights.z * Double(values[hit.triangle.z]);
}

}  // namespace

ReliefSurfaces::ReliefSurfaces(const Scene& scene, const Geometry& geometry, const Illumination& light,
                               const ReliefOptics& optics)
    : scene_(&scene), geometry_(&geometry), light_(&light) {
  if (scene.reliefs.empty()) return;
  if (std::any_of(scene.instances.begin(), scene.instances.end(),
                  [&](const Instance& i) { return !optical(scene, i); }))
    objects_.emplace(scene, [&](int i) { return !optical(scene, scene.instances[static_cast<std::size_t>(i)]); });
  for (std::size_t i = 0; i < scene.reliefs.size(); ++i)
    tracers_.emplace_back(scene, static_cast<int>(i), light, optics);
  for (const Instance& instance : scene.instances) {
    if (instance.relief < 0 || tangents_.contains(instance.mesh)) continue;
    tangents_[instance.mesh] = tangents_of(scene.meshes[static_cast<std::size_t>(instance.mesh)],
                                           fmt::format("'{}' of scene '{}'", instance.name, scene.name));
  }
}

ReliefPlace ReliefSurfaces::place_of(const Hit& hit, const SurfacePoint& point) const {
  const Instance& instance = *hit.instance;
  const Tangents& tangents = tangents_.at(instance.mesh);
  const glm::dmat3 to_world = glm::dmat3(glm::dmat4(instance.to_world));
  ReliefPlace place;
  place.position = point.position;
  place.frame =
      surface_frame(point.normal, to_world * interpolate(tangents.u, hit), to_world * interpolate(tangents.v, hit));
  place.uv = interpolate(scene_->meshes[static_cast<std::size_t>(instance.mesh)].uvs, hit);
  place.tint = point.albedo;
  return place;
}

std::optional<ReliefTracer::Object> ReliefSurfaces::object_on(const glm::dvec3& origin, const glm::dvec3& direction,
                                                              double end_m, std::uint64_t& rays) const {
  if (!objects_) return std::nullopt;
  ++rays;
  const Hit hit = objects_->intersect(origin, direction, 0.0, end_m);
  if (hit.instance == nullptr) return std::nullopt;
  const SurfacePoint point = surface_at(*scene_, *objects_, hit, origin, direction);
  const glm::dvec3 size = glm::abs(point.position);
  const glm::dvec3 start = point.position + 1e-5 * std::max({size.x, size.y, size.z}) * point.normal;
  const auto lit = [&](std::size_t index, const Incidence& in) {
    if (!light_->casts_shadow(index)) return true;
    ++rays;
    return !geometry_->occluded(start, in.to_light, 0.0, in.distance * (1.0 - 1e-6));
  };
  return ReliefTracer::Object{
      hit.distance, light_->surface_radiance(point.position, point.normal, point.albedo, point.emission, lit)};
}

std::optional<ReliefSurfaces::Seen> ReliefSurfaces::seen(const Hit& hit, const SurfacePoint& point,
                                                         const glm::dvec3& direction, Random& random,
                                                         std::uint64_t& rays) const {
  if (!point.front) return std::nullopt;
  const ReliefTracer& tracer = tracers_[static_cast<std::size_t>(hit.instance->relief)];
  const ReliefPlace straight = place_of(hit, point);
  glm::dvec3 v = straight.to_frame(direction);
  v.z = std::min(v.z, -1e-4);  // an interpolated normal may look away
  v = glm::normalize(v);
  ReliefPlace place = straight;
  if (const auto& air = scene_->reliefs[static_cast<std::size_t>(hit.instance->relief)].air) {
    // From where the straight ray enters the air.
    const double way = static_cast<double>(air->height_m) / -v.z;
    std::optional<ReliefTracer::Object> object;
    const auto stops = [&](const glm::dvec3& from, const glm::dvec3& to) {
      const double length = glm::distance(from, to);
      object =
          object_on(straight.position + straight.to_world(from), straight.to_world((to - from) / length), length, rays);
      return object.has_value();
    };
    const BentRay bent =
        bend_through(*air, straight.ray(-way * v, v), 2.0 * way / kAirSteps, objects_ ? std::function(stops) : nullptr);
    const glm::dvec3 onward = straight.to_world(bent.direction);
    if (bent.end == BentRay::End::leaves)
      object = object_on(straight.position + straight.to_world(bent.position), onward,
                         std::numeric_limits<double>::infinity(), rays);
    if (object) return Seen{object->radiance, 0.0};
    if (bent.end == BentRay::End::leaves) return Seen{glm::dvec3(scene_->environment.radiance(glm::vec3(onward))), 0.0};
    place.position += straight.to_world(bent.position);
    place.uv += glm::dvec2(bent.position) / glm::dvec2(place.frame.metres_per_u, place.frame.metres_per_v);
    v = bent.direction;
  }
  const auto met = tracer.first_hit(place, v);
  if (!met) return std::nullopt;
  const auto visible = [&](std::size_t, const glm::dvec3& from, const glm::dvec3& to_light, double distance_m) {
    ++rays;
    const glm::dvec3 size = glm::abs(from);
    const double clearance = 1e-5 * (point.distance + std::max({size.x, size.y, size.z}));
    // The tangent plane of an interpolated normal dips under its own triangle.
    const double above =
        glm::dot(from - point.position, point.face) * (glm::dot(point.face, point.normal) < 0 ? -1 : 1);
    const glm::dvec3 start = from + (clearance + std::max(-above, 0.0)) * place.frame.normal;
    return !geometry_->occluded(start, to_light, 0.0, distance_m * (1.0 - 1e-6));
  };
  const auto objects = [&](const glm::dvec3& from, const glm::dvec3& along, double end_m) {
    return object_on(from, along, end_m, rays);
  };
  // An object that dips in may be met first.
  if (const auto object = objects(place.position, place.to_world(v), met->distance_m))
    return Seen{object->radiance, object->distance_m};
  return Seen{tracer.radiance(place, v, *met, visible, objects, &random), met->distance_m};
}

}  // namespace pellucid
