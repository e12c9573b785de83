#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/geocube/cones/triangle_tree.hpp"
#include "algorithms/reference/embree.hpp"
#include "algorithms/scene/scene.hpp"

namespace pellucid::geocube {

enum class Holes {
  refuse,  ///< an open mesh is an error that says where
  cap      ///< each border loop is closed by a fan about its centre
};

/// Where a ray meets the surface.
struct SurfaceHit {
  std::uint32_t triangle = kNoTriangle;  ///< of the Solid
  double distance = 0;
  glm::dvec3 weights{0.0};  ///< barycentric
  bool leaves = false;      ///< the ray runs from inside to outside here
};

/// The inside of a closed mesh, in the mesh's own space and units: welded, checked, and ready for rays. A rotation, a
/// translation and an even scale carry over to the world as they are; for an uneven one transform the mesh before.
class Solid {
 public:
  /// Throws InputError, naming the mesh and a place in its space: no triangles, no volume, open (with Holes::refuse),
  /// edges with more than two faces or with two that disagree on the side, inside out, or cutting itself.
  explicit Solid(const Mesh& mesh, Holes holes = Holes::refuse);

  const std::string& name() const { return name_; }
  const TriangleTree& tree() const { return tree_; }
  std::size_t triangle_count() const { return tree_.triangles().size(); }
  /// The triangle of the mesh that a triangle of the solid is; nothing for one that caps a hole.
  std::optional<std::uint32_t> source(std::uint32_t triangle) const;
  std::size_t capped_holes() const { return capped_holes_; }

  const glm::dvec3& low() const { return low_; }
  const glm::dvec3& high() const { return high_; }
  double diagonal() const { return glm::length(high_ - low_); }
  double volume() const { return volume_; }
  double area() const { return area_; }
  double area(std::uint32_t triangle) const { return areas_[triangle]; }
  const glm::dvec3& centroid(std::uint32_t triangle) const { return centroids_[triangle]; }
  /// Unit, outward: of the facet, and interpolated as the mesh's normals say.
  const glm::dvec3& facet_normal(std::uint32_t triangle) const { return facet_normals_[triangle]; }
  glm::dvec3 shading_normal(std::uint32_t triangle, const glm::dvec3& weights) const;

  /// The nearest surface beyond `begin` along the ray; `direction` unit. Found in single precision, solved in double.
  std::optional<SurfaceHit> first_hit(const glm::dvec3& origin, const glm::dvec3& direction, double begin = 0) const;
  /// Several directions vote, so that one grazing ray does not decide.
  bool contains(const glm::dvec3& point) const;
  /// True if the straight way from a point inside to the triangle's centroid meets nothing before it, from inside.
  bool sees(const glm::dvec3& inside, std::uint32_t triangle) const;

 private:
  void build_rays();
  /// True if the surface is met before this share of the way.
  bool blocked(const glm::dvec3& from, const glm::dvec3& way, double share) const;

  std::string name_;
  TriangleTree tree_;
  std::vector<std::uint32_t> sources_;
  std::vector<glm::uvec3> normal_corners_;  ///< indices into normals_, by triangle
  std::vector<glm::vec3> normals_;
  std::vector<glm::dvec3> centroids_, facet_normals_;  ///< by triangle
  std::vector<double> areas_;
  std::size_t capped_holes_ = 0;
  glm::dvec3 low_{0.0}, high_{0.0};
  double volume_ = 0, area_ = 0;
  embree::Device device_;
  embree::Bvh rays_;
};

}  // namespace pellucid::geocube
