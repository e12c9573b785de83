#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/scene/scene.hpp"

/// From a mesh whose vertices are split at creases and seams to a closed surface.
namespace pellucid::geocube {

inline constexpr std::uint32_t kCap = ~0U;

struct Welded {
  std::vector<glm::dvec3> positions;   ///< each place once
  std::vector<glm::uvec3> triangles;   ///< none with a corner twice
  std::vector<std::uint32_t> sources;  ///< the mesh's triangle, or kCap
};

/// Corners at one place become one vertex; what is nearer than `tolerance` is one place too.
Welded weld(const Mesh&, double tolerance);

/// A closed ring of edges with a face on one side only, in the order in which a cap would run through them.
using Border = std::vector<std::uint32_t>;

/// How a surface fails to be closed.
struct Topology {
  std::vector<Border> borders;
  std::size_t open_edges = 0;
  std::string fault;  ///< what no cap can mend, with its place; empty when there is none
};
Topology topology(const Welded&);

/// Closes a border by triangles about the mean of its corners.
void cap(Welded&, const Border&);

/// "(0.1, 2, −3)"
std::string place(const glm::dvec3&);

}  // namespace pellucid::geocube
