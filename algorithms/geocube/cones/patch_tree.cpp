#include "algorithms/geocube/cones/patch_tree.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include <tbb/parallel_for.h>

namespace pellucid::geocube {
namespace {

/// The texels of one face that a cell covers: [x0, x1] × [y0, y1].
struct Block {
  int face = 0, x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct Patch {
  glm::dvec3 centre{0.0};
  std::array<glm::dvec3, 3> edges{};
  bool points = false, gaps = false;
};

class Fit {
 public:
  Fit(const CubeGrid& grid, const Sheet& sheet, const Block& block) : grid_(grid), sheet_(sheet), block_(block) {}

  Patch patch() const {
    Patch result;
    const std::array<glm::dvec3, 3> edges = directions();
    // Coordinates along the edges, which need not be perpendicular.
    const double volume = glm::dot(edges[0], glm::cross(edges[1], edges[2]));
    const std::array<glm::dvec3, 3> across{glm::cross(edges[1], edges[2]) / volume,
                                           glm::cross(edges[2], edges[0]) / volume,
                                           glm::cross(edges[0], edges[1]) / volume};
    glm::dvec3 low(1e300), high(-1e300);
    for (int y = block_.y0; y <= block_.y1; ++y) {
      for (int x = block_.x0; x <= block_.x1; ++x) {
        const std::size_t texel = grid_.index({block_.face, x, y});
        if (sheet_.present[texel] == 0) {
          result.gaps = true;
          continue;
        }
        result.points = true;
        const glm::dvec3& p = sheet_.points[texel];
        const glm::dvec3 at(glm::dot(p, across[0]), glm::dot(p, across[1]), glm::dot(p, across[2]));
        low = glm::min(low, at);
        high = glm::max(high, at);
      }
    }
    if (!result.points) return result;
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      result.centre += 0.5 * (low[k] + high[k]) * edges[i];
      result.edges[i] = 0.5 * (high[k] - low[k]) * edges[i];
    }
    return result;
  }

 private:
  // Unit vectors along the block's rows and columns of points and perpendicular to both; the axes of space where these
  // do not exist.
  std::array<glm::dvec3, 3> directions() const {
    static constexpr double kLeastSine = 1e-3;
    const std::array<glm::dvec3, 3> axes{glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)};
    const std::array<std::size_t, 4> corners{at(block_.x0, block_.y0), at(block_.x1, block_.y0),
                                             at(block_.x0, block_.y1), at(block_.x1, block_.y1)};
    for (const std::size_t corner : corners) {
      if (sheet_.present[corner] == 0) return axes;
    }
    const auto p = [&](std::size_t k) { return sheet_.points[corners[k]]; };
    const glm::dvec3 along_rows = p(1) + p(3) - p(0) - p(2), along_columns = p(2) + p(3) - p(0) - p(1);
    const glm::dvec3 normal = glm::cross(along_rows, along_columns);
    const double lengths = glm::length(along_rows) * glm::length(along_columns);
    if (!(glm::length(normal) > kLeastSine * lengths)) return axes;
    return {glm::normalize(along_rows), glm::normalize(along_columns), glm::normalize(normal)};
  }
  std::size_t at(int x, int y) const { return grid_.index({block_.face, x, y}); }

  const CubeGrid& grid_;
  const Sheet& sheet_;
  const Block& block_;
};

void set(Quarters& quarters, std::size_t k, const Patch& patch) {
  quarters.centre.set(k, patch.centre);
  for (std::size_t i = 0; i < 3; ++i)
    quarters.edges[i].set(k, patch.edges[i]);
  quarters.gap[k] = patch.gaps ? std::numeric_limits<float>::infinity() : 0.0F;
  if (!patch.points) return;
  glm::dvec3 reach = glm::abs(patch.centre);
  for (const glm::dvec3& edge : patch.edges)
    reach += glm::abs(edge);
  quarters.size[k] = static_cast<float>(std::max({reach.x, reach.y, reach.z}));
}

}  // namespace

PatchTree::PatchTree(const CubeGrid& grid, const Sheet& sheet) : n_(grid.n()) {
  assert(grid.n() > 1);
  std::uint32_t below = 0;  // the first cell of the level below
  for (int size = 2, width = grid.n(); width > 1; size *= 2) {
    const int width_below = width;
    width = (width + 1) / 2;
    const auto first = static_cast<std::uint32_t>(cells_.size());
    cells_.resize(first + static_cast<std::size_t>(6 * width * width));
    if (size == 2) lowest_ = static_cast<std::uint32_t>(cells_.size());
    tbb::parallel_for(0, 6 * width, [&](int row) {
      const int face = row / width, y = row % width, half = size / 2;
      for (int x = 0; x < width; ++x) {
        Quarters& cell = cells_[first + static_cast<std::uint32_t>(row * width + x)];
        for (int k = 0; k < 4; ++k) {
          const int u = 2 * x + k % 2, v = 2 * y + k / 2;
          if (u >= width_below || v >= width_below) continue;
          const Block block{face, u * half, v * half, std::min((u + 1) * half, grid.n()) - 1,
                            std::min((v + 1) * half, grid.n()) - 1};
          const auto lane = static_cast<std::size_t>(k);
          cell.child[lane] = below + static_cast<std::uint32_t>((face * width_below + v) * width_below + u);
          set(cell, lane, Fit(grid, sheet, block).patch());
        }
      }
    });
    below = first;
  }
  for (std::uint32_t face = 0; face < 6; ++face)
    roots_[face] = below + face;
}

}  // namespace pellucid::geocube
