#include "algorithms/reference/translucent_path.hpp"

#include <cmath>

#include "algorithms/reference/interface_bend.hpp"
#include "algorithms/reference/media/phase.hpp"
#include "algorithms/shaders/optics.hpp"

namespace pellucid {
namespace {

double uniform(Random& random) {
  return static_cast<double>(random.next());
}

}  // namespace

bool has_scattering(const Scene& scene) {
  return std::any_of(scene.instances.begin(), scene.instances.end(),
                     [&](const Instance& instance) { return material_of(scene, instance).scatters(); });
}

const Material* TranslucentPath::medium(const Walker& walker) const {
  if (walker.inside.empty()) return nullptr;
  const Material& material = material_of(*scene_, walker.inside.innermost());
  return material.scatters() || material.absorption != glm::vec3(0.0F) ? &material : nullptr;
}

// True if the walker scatters before `distance`; else it has gone that far.
bool TranslucentPath::scatter(Walker& walker, const Material& material, double distance, Random& random) const {
  const glm::dvec3 scattering(material.scattering), extinction = scattering + glm::dvec3(material.absorption);
  const auto left = [&](double s) {
    glm::dvec3 out(1.0);
    for (int c = 0; c < 3; ++c) {
      if (extinction[c] > 0) out[c] = std::exp(-extinction[c] * s);  // the distance may be infinite
    }
    return out;
  };
  if (!material.scatters()) {
    walker.weight *= left(distance);
    return false;
  }
  const double drawn = extinction[walker.channel];
  const double s = drawn > 0 ? -std::log(1 - uniform(random)) / drawn : std::numeric_limits<double>::infinity();
  const bool scatters = s < distance;
  const glm::dvec3 t = left(scatters ? s : distance);
  walker.left *= scatters ? scattering * t : t;
  walker.likelihood *= scatters ? extinction * t : t;
  const double scale = 1 / walker.likelihood[walker.channel];
  walker.left *= scale;
  walker.likelihood *= scale;
  if (!scatters) return false;
  walker.start += s * walker.direction;
  walker.direction = deflected(walker.direction, static_cast<double>(material.anisotropy), random);
  walker.from = {};
  walker.scattered = true;
  if (++walker.events > kMostEvents) walker.ended = true;
  roulette(walker, random);
  return true;
}

// Paths of little weight go on with a probability and weigh more for it.
void TranslucentPath::roulette(Walker& walker, Random& random) {
  constexpr double kLow = 0.1;
  const double weight = worst(walker.light());
  if (weight >= kLow || walker.ended) return;
  const double share = weight / kLow;
  if (uniform(random) >= share)
    walker.ended = true;
  else
    walker.weight /= share;
}

// Towards where `direction` leads off the near side of the surface.
void TranslucentPath::reflect_off(Walker& walker, const SurfacePoint& point, const TreeLimits& limits,
                                  const glm::dvec3& direction, TreeTally& tally) {
  const bool allowed = point.front ? walker.scattered || limits.entry_reflection
                                   : walker.scattered || walker.reflections < limits.reflections;
  if (!allowed) {
    tally.limited_weight += worst(walker.light());
    walker.ended = true;
    return;
  }
  if (!point.front) ++walker.reflections;
  walker.direction = direction;
}

void TranslucentPath::interact(Walker& walker, const Hit& hit, const SurfacePoint& point, const TreeLimits& limits,
                               Random& random, TreeTally& tally, Walker* other) const {
  const Material& material = material_of(*scene_, *hit.instance);
  const glm::dvec3 arriving = walker.direction;
  walker.from = hit;
  walker.start = point.position;
  walker.face = point.face;
  if (++walker.events > kMostEvents) {
    tally.cut_weight += worst(walker.light());
    walker.ended = true;
    return;
  }
  if (material.kind != SurfaceKind::dielectric) {
    const Bend bend = reflect_at(arriving, point.normal, point.face);
    glm::dvec3 share(material.reflectance);
    if (material.kind == SurfaceKind::metal)
      share *= fresnel_metal(bend.cosine, glm::dvec3(material.metal_n), glm::dvec3(material.metal_k));
    walker.weight *= share;
    walker.direction = bend.reflected;
    roulette(walker, random);
    return;
  }
  if (point.front == walker.inside.contains(hit.index)) {
    tally.lost_weight += worst(walker.light());
    // Inside and met from outside: rounding has it on the wrong side of a sharp edge, whose faces would refract it to
    // each other for ever.
    walker.ended = point.front;
    if (walker.ended) return;
  }
  const double ior = static_cast<double>(material.ior);
  const Split split = split_at(arriving, point.normal, point.face, point.front ? 1.0 / ior : ior);
  const double reflected = split.refracted ? split.reflected_share : 1.0;
  bool reflects = false;
  if (other != nullptr && reflected > 0.0 && reflected < 1.0) {
    *other = walker;
    other->weight *= reflected;
    reflect_off(*other, point, limits, split.reflected, tally);
    walker.weight *= 1.0 - reflected;
  } else {
    reflects = uniform(random) < reflected;
  }
  if (reflects) {
    reflect_off(walker, point, limits, split.reflected, tally);
    return;
  }
  walker.direction = *split.refracted;
  walker.face = -point.face;
  if (point.front) {
    walker.inside.enter(hit.index);
  } else {
    walker.inside.leave(hit.index);
    if (walker.inside.empty()) walker.reflections = 0;
  }
}

}  // namespace pellucid
