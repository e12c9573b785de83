#pragma once

#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/scene/scene.hpp"

/// Cutting a volume's box with planes parallel to the screen, on the CPU, in the box's local coordinates [0,1]³
/// (Imagire et al. 2007, Sec. 3.2 and 4; also the image-aligned slices of Cullip and Neumann 1994).
namespace pellucid {

/// View depth (distance along the viewing axis, metres) as an affine function of local coordinates.
struct BoxDepth {
  glm::dvec3 gradient{0.0};
  double offset = 0;
  bool mirrored = false;  ///< to_world turns right hands into left ones

  BoxDepth(const glm::mat4& to_world, const glm::mat4& world_to_view);
  double operator()(const glm::dvec3& local) const { return glm::dot(gradient, local) + offset; }
};

/// The depths that the box spans in front of the near plane.
struct DepthRange {
  double front = 0;
  double back = 0;
  bool clipped = false;  ///< the near plane cuts the box, or the camera is inside
};
/// Nothing when the whole box lies behind the near plane.
std::optional<DepthRange> depth_range(const BoxDepth&, double near_m);

/// Triangles of several convex pieces, farthest first; vertices are local coordinates. Seen from the eye, faces that
/// turn towards it are counter-clockwise.
struct BoxPieces {
  std::vector<glm::vec3> vertices;
  struct Piece {
    int first = 0;
    int count = 0;
  };
  std::vector<Piece> pieces;
};

/// M closed convex polyhedra of equal thickness in depth. Neighbours share their vertices to the bit, so that the
/// rasteriser leaves no gap between them.
BoxPieces cut_hulls(const BoxDepth&, const DepthRange&, int hulls);

/// One piece: `slices` polygons, each in the middle of its slab of equal thickness, farthest first.
BoxPieces cut_slices(const BoxDepth&, const DepthRange&, int slices);

/// Slices across the box's edge direction nearest to the viewing axis. Those on either side of the eye come from the
/// outside in, which is back to front for every ray.
struct ObjectSlices {
  BoxPieces polygons;    ///< one piece
  glm::vec3 axis{0.0F};  ///< unit normal of the slices, in the world
  float slab_m = 0;      ///< thickness that a slice stands for, along `axis`
};
ObjectSlices cut_object_slices(const glm::mat4& to_world, const glm::mat4& world_to_view, const glm::vec3& eye,
                               int slices);

}  // namespace pellucid
