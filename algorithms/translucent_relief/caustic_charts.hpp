#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/scene/scene.hpp"

/// A mesh laid out over its texture, for maps of the light that a relief's medium gathers.
namespace pellucid::translucent_relief {

/// A node of a regular grid over [0, 1]² of a mesh's texture, in the mesh's own space. Four texels of four floats.
struct CausticNode {
  glm::vec4 position{0.0F};                            ///< w: 1 where the mesh covers the node or one beside it, else 0
  glm::vec4 normal{0.0F}, over_u{0.0F}, over_v{0.0F};  ///< over a unit of u and v [m]; w: 0
};

/// Pieces of the mesh that hang together, put into layers, so that no two of a layer cover the same part of the
/// texture.
struct CausticCharts {
  int side = 0;                                  ///< nodes along a side of the grid
  std::vector<std::vector<CausticNode>> layers;  ///< of nodes, row by row, first row at v = 0
  std::vector<std::uint32_t> layer_of_triangle;
  std::vector<glm::bvec2> closes;  ///< by layer: the mesh's first and last nodes over u, over v, are the same places
  bool affine = false;             ///< a flat mesh whose texture is not bent
};

inline constexpr int kMostCausticLayers = 64;

/// `side`: nodes along a side, at least 2. InputError, which names `what`: no texture coordinates or tangents,
/// coordinates beyond [0, 1], a piece that lies over itself, more layers than there may be.
CausticCharts caustic_charts(const Mesh&, int side, const std::string& what);

}  // namespace pellucid::translucent_relief
