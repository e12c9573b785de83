#pragma once

#include <cstddef>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/reference/box_tree.hpp"
#include "algorithms/reference/interval.hpp"
#include "algorithms/scene/scene.hpp"

/// Where along a ray the opaque objects keep a light away, exactly. A ray and a light span a plane; the triangles that
/// the plane cuts leave line segments in it, and the shadow on the ray is the union of these segments' projections from
/// the light. So no shadow is too thin to be found, and no edge of one needs a search.
namespace pellucid {

class RayShadows {
 public:
  explicit RayShadows(const Scene&);

  /// Appends the shadows on origin + t·direction, t in `part`, rising and apart. `light`: its position and 1, or the
  /// unit vector towards a directional one and 0. `direction` unit. A light straight ahead on the ray spans no plane
  /// with it and is taken to stand 1e-7 of its distance aside (1e-7 of a radian, if directional).
  void find(const glm::dvec3& origin, const glm::dvec3& direction, const Interval& part, const glm::dvec4& light,
            std::vector<Interval>& shadows) const;

 private:
  struct Triangle {
    glm::vec3 corner[3];
  };
  struct MeshTree {
    std::vector<Triangle> triangles;  // in the tree's order
    BoxTree tree;
  };
  struct Placed {
    std::size_t mesh;
    glm::dmat4 to_mesh;
  };
  static MeshTree build(const Mesh& mesh);

  std::vector<MeshTree> meshes_;
  std::vector<Placed> instances_;  // in the tree's order
  BoxTree tree_;
};

}  // namespace pellucid
