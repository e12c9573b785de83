#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/reference/embree.hpp"
#include "algorithms/scene/scene.hpp"

/// The objects of a scene, ready for single rays (Embree).
namespace pellucid {

/// Where a ray meets a surface.
struct Hit {
  const Instance* instance = nullptr;  ///< null: nothing was hit
  int index = -1;                      ///< of the instance in the scene
  unsigned primitive = 0;              ///< of the triangle in the mesh
  glm::uvec3 triangle{0};
  glm::dvec3 weights{0.0};  ///< barycentric
  double distance = std::numeric_limits<double>::infinity();
};

/// One bounding-volume hierarchy for each mesh and one over their instances. Keeps the scene's address.
class Geometry {
 public:
  /// The instances for whose index `included` is true; without it, all. RuntimeError if Embree cannot.
  explicit Geometry(const Scene&, const std::function<bool(int)>& included = {});

  /// The nearest surface between `begin` and `end` metres along the ray; `direction` unit. The triangle is found in
  /// single precision, the distance and the weights are then solved in double.
  Hit intersect(const glm::dvec3& origin, const glm::dvec3& direction, double begin, double end) const;
  /// The nearest surface that a ray meets which sets out from `start`, a point on the triangle of `from` where its unit
  /// normal on the ray's side is `face`. It never meets that triangle itself. Distances are from `start`, ≥ 0.
  Hit intersect_from(const glm::dvec3& start, const Hit& from, const glm::dvec3& face,
                     const glm::dvec3& direction) const;
  /// True if anything lies between `begin` and `end` metres along the ray, in single precision.
  bool occluded(const glm::dvec3& origin, const glm::dvec3& direction, double begin, double end) const;
  /// How normals of an instance come to the world: the inverse transpose of its linear part.
  const glm::dmat3& normal_to_world(int index) const { return normals_[static_cast<std::size_t>(index)]; }

 private:
  Hit nearest(const glm::dvec3& embree_origin, const glm::dvec3& origin, const glm::dvec3& direction, double begin,
              double end, float* met_at = nullptr) const;

  const Scene* scene_;
  std::vector<glm::dmat4> to_world_;  // by instance
  std::vector<glm::dmat3> normals_;
  embree::Device device_;
  std::vector<embree::Bvh> meshes_;  // null where no instance uses the mesh
  embree::Bvh root_;
};

}  // namespace pellucid
