#pragma once

#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/scene/scene.hpp"

/// Where light that falls on a mesh is kept: every point of its surface has a place of its own in [0, 1]².
namespace pellucid::distance_impostors {

struct LightMapChart {
  std::vector<glm::vec2> places;  ///< by vertex
  std::vector<int> parts;         ///< by vertex: places are continuous within a part
  int part_count = 0;
};

/// The mesh's own texture coordinates where they keep its triangles apart; else each of its connected parts has a cell
/// of a square grid, with a margin of `margin` texels of `texels`, if its own coordinates keep it apart. Nothing
/// without texture coordinates, or when they cover places twice all the same, or in more than kMaxParts parts.
inline constexpr int kMaxParts = 64;
std::optional<LightMapChart> make_chart(const Mesh&, int texels, int margin);

}  // namespace pellucid::distance_impostors
