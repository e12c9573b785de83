#include "algorithms/reference/interfaces.hpp"

#include <cassert>
#include <cmath>
#include <mutex>

#include "algorithms/reference/geometry.hpp"
#include "algorithms/reference/interface_bend.hpp"
#include "algorithms/reference/surface_point.hpp"

namespace pellucid {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

// The hierarchy without one instance, and that of it alone, each made when it is first asked for.
struct Parts {
  std::once_flag without_made, alone_made;
  std::unique_ptr<Geometry> without, alone;
};

}  // namespace

const InnerVertex* InnerPath::first_exit() const {
  for (const InnerVertex& vertex : vertices) {
    if (vertex.leaving) return &vertex;
  }
  return nullptr;
}

struct InterfaceTracer::State {
  explicit State(const Scene& s) : scene(s), all(s), parts(s.instances.size()) {}

  const Geometry& without(int instance) {
    if (instance < 0) return all;
    Parts& part = parts[static_cast<std::size_t>(instance)];
    std::call_once(part.without_made, [&] {
      part.without = std::make_unique<Geometry>(scene, [&](int other) { return other != instance; });
    });
    return *part.without;
  }
  const Geometry& alone(int instance) {
    Parts& part = parts[static_cast<std::size_t>(instance)];
    std::call_once(part.alone_made, [&] {
      part.alone = std::make_unique<Geometry>(scene, [&](int other) { return other == instance; });
    });
    return *part.alone;
  }

  InterfaceHit described(const Hit& hit, const glm::dvec3& origin, const glm::dvec3& direction) const {
    InterfaceHit result;
    if (hit.instance == nullptr) return result;
    const SurfacePoint point = surface_at(scene, all, hit, origin, direction);
    result.instance = hit.index;
    result.distance_m = hit.distance;
    result.position = point.position;
    result.front = point.front;
    result.normal = point.front ? point.normal : -point.normal;
    result.face = point.front ? point.face : -point.face;
    result.primitive = hit.primitive;
    return result;
  }

  // From a hit on: `direction` may leave to either side of it.
  InterfaceHit from(const Geometry& geometry, const InterfaceHit& start, const glm::dvec3& direction) const {
    assert(start && "a ray starts at a hit");
    Hit left;
    left.index = start.instance;
    left.primitive = start.primitive;
    const glm::dvec3 side = glm::dot(direction, start.face) >= 0.0 ? start.face : -start.face;
    return described(geometry.intersect_from(start.position, left, side, direction), start.position, direction);
  }

  double ior(int instance) const { return static_cast<double>(material_of(scene, instance).ior); }

  Split split(const InterfaceHit& hit, const glm::dvec3& direction) const {
    const double side = hit.front ? 1.0 : -1.0;
    return split_at(direction, side * hit.normal, side * hit.face,
                    hit.front ? 1.0 / ior(hit.instance) : ior(hit.instance));
  }

  // Adds the boundary points from `hit` on, which the ray has reached inside the solid after `path_m`.
  void follow(InnerPath& path, InterfaceHit hit, glm::dvec3 direction, int reflections) {
    const Geometry& solid = alone(hit.instance);
    double path_m = hit.distance_m;
    for (int i = 0; i <= reflections && hit; ++i) {
      if (hit.front) return;  // through a hole, or a shell inside out
      const Split split = this->split(hit, direction);
      path.vertices.push_back({hit, direction, split.refracted, split.reflected_share, path_m});
      if (i == reflections) return;
      direction = split.reflected;
      hit = from(solid, hit, direction);
      path_m += hit.distance_m;
    }
  }

  const Scene& scene;
  Geometry all;
  std::vector<Parts> parts;
};

InterfaceTracer::InterfaceTracer(const Scene& scene) : state_(std::make_unique<State>(scene)) {}
InterfaceTracer::~InterfaceTracer() = default;
InterfaceTracer::InterfaceTracer(InterfaceTracer&&) noexcept = default;
InterfaceTracer& InterfaceTracer::operator=(InterfaceTracer&&) noexcept = default;

InterfaceHit InterfaceTracer::primary(const Camera& camera, int x, int y) const {
  const glm::dvec3 origin(camera.view.eye), direction = camera.ray_direction(x + 0.5, y + 0.5);
  const glm::dvec3 forward = glm::normalize(glm::dvec3(camera.view.target) - origin);
  const double per_depth = 1.0 / glm::dot(direction, forward);
  return state_->described(state_->all.intersect(origin, direction, static_cast<double>(camera.view.near_m) * per_depth,
                                                 static_cast<double>(camera.view.far_m) * per_depth),
                           origin, direction);
}

InterfaceHit InterfaceTracer::nearest(const glm::dvec3& origin, const glm::dvec3& direction) const {
  return nearest_without(origin, direction, -1);
}

InterfaceHit InterfaceTracer::nearest_without(const glm::dvec3& origin, const glm::dvec3& direction,
                                              int without) const {
  return state_->described(state_->without(without).intersect(origin, direction, 0.0, kEndless), origin, direction);
}

InterfaceHit InterfaceTracer::next(const InterfaceHit& from, const glm::dvec3& direction, int without) const {
  return state_->from(state_->without(without), from, direction);
}

glm::dvec3 InterfaceTracer::reflected_at(const InterfaceHit& hit, const glm::dvec3& direction) const {
  const double side = hit.front ? 1.0 : -1.0;
  return reflect_at(direction, side * hit.normal, side * hit.face).reflected;
}

std::optional<glm::dvec3> InterfaceTracer::refracted_at(const InterfaceHit& hit, const glm::dvec3& direction) const {
  return state_->split(hit, direction).refracted;
}

InnerPath InterfaceTracer::through(const InterfaceHit& entry, const glm::dvec3& direction, int reflections) const {
  assert(entry && entry.front && reflections >= 0);
  InnerPath path;
  const Split split = state_->split(entry, direction);
  path.entry_reflected_share = split.reflected_share;
  if (!split.refracted) return path;
  path.entering = *split.refracted;
  const InterfaceHit hit = state_->from(state_->alone(entry.instance), entry, path.entering);
  if (hit) state_->follow(path, hit, path.entering, reflections);
  return path;
}

InnerPath InterfaceTracer::inside(int instance, const glm::dvec3& origin, const glm::dvec3& direction,
                                  int reflections) const {
  assert(reflections >= 0);
  InnerPath path;
  path.entering = direction;
  const InterfaceHit hit =
      state_->described(state_->alone(instance).intersect(origin, direction, 0.0, kEndless), origin, direction);
  if (hit) state_->follow(path, hit, direction, reflections);
  return path;
}

double InterfaceTracer::diagonal_m(int instance) const {
  const Instance& object = state_->scene.instances[static_cast<std::size_t>(instance)];
  glm::dvec3 low(kEndless), high(-kEndless);
  for (const glm::vec3& position : state_->scene.meshes[static_cast<std::size_t>(object.mesh)].positions) {
    const glm::dvec3 p(glm::dmat4(object.to_world) * glm::dvec4(glm::dvec3(position), 1.0));
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  return glm::any(glm::greaterThan(low, high)) ? 0.0 : glm::distance(low, high);
}

}  // namespace pellucid
