#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <glm/glm.hpp>

struct RTCDeviceTy;
struct RTCSceneTy;

/// Embree as the project uses it: hierarchies of triangles and of their instances, and single rays through them. No
/// other file knows Embree's headers, whose two versions in use differ. Every call may throw RuntimeError but for the
/// rays.
namespace pellucid::embree {

struct Release {
  void operator()(RTCDeviceTy*) const;
  void operator()(RTCSceneTy*) const;
};
using Device = std::unique_ptr<RTCDeviceTy, Release>;
/// A hierarchy; its device must outlive it.
using Bvh = std::unique_ptr<RTCSceneTy, Release>;

Device make_device();

/// One mesh, ready for rays; `name` is told should memory run out.
Bvh triangles_bvh(const Device&, std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                  const std::string& name);

/// Instances of others, each added by the number under which hits name it, until finish() makes them ready for rays.
Bvh empty_bvh(const Device&);
void add_instance(const Device&, const Bvh& to, const Bvh& of, const glm::mat4& to_world, unsigned number);
void finish(const Device&, const Bvh&);

struct Ray {
  glm::dvec3 origin{0.0}, direction{0.0};  ///< the direction's length is the unit of all distances
  double begin = 0, end = 0;
};

/// All in single precision.
struct Hit {
  unsigned instance = 0;  ///< of a hierarchy of instances
  unsigned triangle = 0;
  float distance = 0;
  float u = 0, v = 0;  ///< barycentric, of the second and the third corner
};

std::optional<Hit> nearest(const Bvh&, const Ray&);
bool occluded(const Bvh&, const Ray&);

}  // namespace pellucid::embree
