#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/geocube/cube_grid.hpp"
#include "algorithms/geocube/solid.hpp"

/// The precomputation of Chan and Wang 2005, Sec. 2.1 (references.bib: chan2005): distances, normals and the solids
/// that a ray may cross unchecked, by direction from a few points inside.
namespace pellucid::geocube {

enum class ConeBase {
  inscribed,  ///< cone B is the widest in which the surface stays within ±ε/2 of the tangent plane at S
  enclosing   ///< cone B is the narrowest that holds the mesh near S within ±ε/2, as the paper words it
};

struct CubeOptions {
  int resolution = 64;    ///< texels along a face's edge, 8 to 512
  int layers = 1;         ///< intervals of the inside along a direction, 1 to 8; 1 as in the paper
  double epsilon = 0.04;  ///< ε, as a share of the solid's diagonal; above 0
  ConeBase cone_b = ConeBase::inscribed;
  bool use_a = true, use_b = true, use_c = true, use_d = true;
  double ior = 1.5;  ///< η, above 0; cone C's half-angle is arcsin(1/η), 90° below η = 1
};

/// One distance layer of a cube map, a value for each texel in CubeGrid's order: what OpenGL takes as RGBA32F. Along
/// direction v the inside runs from `inner` to `distance`; both are 0 where the direction has no such layer.
struct CubeLayer {
  std::vector<glm::vec4> bounds;  ///< distance d, cos θ_A, cos θ_B, R_C; a cone that is left out is a line: cosine 1
  /// Outward unit normal N at S = O + d·v; inner distance. A single layer has none: 1 where the inside begins
  /// again behind S, in this direction or a neighbour's, else 0.
  std::vector<glm::vec4> planes;
  std::vector<glm::vec4> inners;  ///< outward unit normal at the inner distance and R_C there; empty for layer 0
};

/// A geocube. In layers beyond the first, cone A is a pair, from either end of the interval to its middle, and cone B
/// is cut off by the tangent planes at both ends.
struct Cube {
  glm::dvec3 center{0.0};
  float sphere = 0;  ///< radius of sphere D; 0 when it is left out
  std::vector<CubeLayer> layers;
  double dropped_share = 0;  ///< of the directions: those that would need more layers
};

struct CubeSet {
  CubeOptions options;
  double diagonal = 0;  ///< of the solid's box, the unit of ε and of errors
  std::vector<Cube> cubes;
  std::vector<std::uint8_t> first_cube;  ///< for each triangle of the mesh: the cube of a ray that enters there
  double unseen_share = 0;               ///< of the solid's area: triangles that no centre sees
  double build_s = 0;                    ///< what it took, on the machine that built it

  CubeGrid grid() const { return CubeGrid(options.resolution); }
};

inline constexpr std::size_t kMaxCubes = 16;

/// Throws InputError: options out of range, no centre or more than kMaxCubes, a centre outside the solid or on its
/// surface.
CubeSet build_cubes(const Solid&, std::span<const glm::dvec3> centers, const CubeOptions&);

/// The bytes that the cube maps take on the device, for each layer two or three RGBA32F cube maps.
std::size_t texture_bytes(const CubeOptions&, std::size_t cubes);

/// For each triangle of the solid the nearest centre that sees it (Sec. 2.3); kUnseen where there is none.
inline constexpr std::uint8_t kUnseen = 255;
std::vector<std::uint8_t> nearest_seeing(const Solid&, std::span<const glm::dvec3> centers);

}  // namespace pellucid::geocube
