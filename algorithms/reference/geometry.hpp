#pragma once

#include <limits>
#include <memory>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/scene/scene.hpp"

struct RTCDeviceTy;
struct RTCSceneTy;

/// The opaque objects of a scene, ready for single rays (Embree).
namespace pellucid {

/// Where a ray meets a surface.
struct Hit {
  const Instance* instance = nullptr;  ///< null: nothing was hit
  glm::uvec3 triangle{0};
  glm::dvec3 weights{0.0};  ///< barycentric
  double distance = std::numeric_limits<double>::infinity();
};

/// One bounding-volume hierarchy for each mesh and one over their instances. Keeps the scene's address.
class Geometry {
 public:
  explicit Geometry(const Scene&);  ///< RuntimeError if Embree cannot

  /// The nearest surface between `begin` and `end` metres along the ray; `direction` unit. The triangle is found in
  /// single precision, the distance and the weights are then solved in double.
  Hit intersect(const glm::dvec3& origin, const glm::dvec3& direction, double begin, double end) const;
  /// True if anything lies between `begin` and `end` metres along the ray, in single precision.
  bool occluded(const glm::dvec3& origin, const glm::dvec3& direction, double begin, double end) const;

 private:
  struct Release {
    void operator()(RTCDeviceTy* device) const;
    void operator()(RTCSceneTy* scene) const;
  };
  using Device = std::unique_ptr<RTCDeviceTy, Release>;
  using Bvh = std::unique_ptr<RTCSceneTy, Release>;

  Bvh build(const Mesh& mesh) const;

  const Scene* scene_;
  Device device_;
  std::vector<Bvh> meshes_;  // null where no instance uses the mesh
  Bvh root_;
};

}  // namespace pellucid
