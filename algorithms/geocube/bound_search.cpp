#include "algorithms/geocube/bound_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include <tbb/parallel_for.h>

namespace pellucid::geocube {
namespace {

constexpr double kNone = -2;  // below any cosine
constexpr double kRounding = 1e-9;

/// The widest cone so far that still holds nothing, about the axis.
struct Narrowest {
  double cosine = -1, sine = 0;
  explicit Narrowest(double c) : cosine(c), sine(std::sqrt(std::max(0.0, 1 - c * c))) {}
};

/// A cell's extent, seen from the cone's apex: a disc's middle by its place along and across the axis, its normal in
/// the plane of axis and middle, and how far it reaches within the disc's plane and off it.
struct Candidate {
  double along = 0, across = 0, radius = -1, thickness = 0;
  double normal_along = 0, normal_across = 0;
  double outside = 0;  // how far it was outside the cone, at most
  int level = 0, face = 0, x = 0, y = 0;

  // A lower bound of how far the cell's points are outside the cone. For cones up to 90° that distance is convex, so
  // that it is at least its linear part about the middle: where the surface touches the cone it lies along it, and
  // counts by its thickness, which falls with the square of its size.
  double nearest(const Narrowest& cone) const {
    const double off = normal_across * cone.cosine - normal_along * cone.sine;
    return across * cone.cosine - along * cone.sine - std::abs(off) * thickness -
           std::sqrt(std::max(0.0, 1 - off * off)) * radius;
  }
  // False when it lies outside the cone and so cannot narrow it.
  bool meets(const Narrowest& cone) const {
    if (cone.cosine > 0 && along * cone.cosine + across * cone.sine < 0 &&
        along * along + across * across >= radius * radius)
      return false;
    return nearest(cone) < 0;
  }
};

// Depth first, the most promising cell first. `cover(index, candidate)` tells what a cell covers, false if nothing of
// interest; `score(texel)` is the cosine of what narrows the cone.
template <class Cover, class Score>
double search(const SheetTree& tree, double best, std::size_t& found, Cover cover, Score score) {
  std::array<Candidate, 96> stack;
  std::size_t depth = 0;
  Narrowest cone(best);
  const auto push = [&](int level, int face, int x, int y, std::size_t base) {
    Candidate c{.level = level, .face = face, .x = x, .y = y};
    if (!cover(tree.at(level, face, x, y), c) || !c.meets(cone)) return;
    c.outside = c.across * cone.cosine - c.along * cone.sine;
    std::size_t i = depth++;
    for (; i > base && stack[i - 1].outside < c.outside; --i)
      stack[i] = stack[i - 1];
    stack[i] = c;
  };
  const int top = tree.levels() - 1;
  for (int face = 0; face < 6; ++face)
    push(top, face, 0, 0, 0);
  while (depth > 0) {
    const Candidate c = stack[--depth];
    if (!c.meets(cone)) continue;
    if (c.level == 0) {
      const std::size_t texel = tree.grid().index({c.face, c.x, c.y});
      const double value = score(texel);
      if (value > best) {
        best = value;
        cone = Narrowest(best);
        found = texel;
      }
      continue;
    }
    const std::size_t base = depth;
    const int width = tree.width(c.level - 1);
    const int x1 = std::min(2 * c.x + 1, width - 1), y1 = std::min(2 * c.y + 1, width - 1);
    for (int y = 2 * c.y; y <= y1; ++y) {
      for (int x = 2 * c.x; x <= x1; ++x)
        push(c.level - 1, c.face, x, y, base);
    }
  }
  return best;
}

}  // namespace

SheetTree::SheetTree(const CubeGrid& grid, Sheet sheet) : grid_(grid), sheet_(std::move(sheet)) {
  std::size_t total = 0;
  for (int w = grid.n();; w = (w + 1) / 2) {
    widths_.push_back(w);
    offsets_.push_back(total);
    total += 6 * static_cast<std::size_t>(w) * static_cast<std::size_t>(w);
    if (w == 1) break;
  }
  cells_.resize(total);
  ranges_.resize(total);
  for (std::size_t i = 0; i < grid.texels(); ++i) {
    if (sheet_.present[i] != 0) cells_[i].centre = sheet_.points[i], cells_[i].radius = 0;
    cells_[i].gaps = sheet_.present[i] == 0;
    ranges_[i].axis = grid.direction(i);
  }
  for (int level = 1; level < levels(); ++level) {
    tbb::parallel_for(0, 6 * width(level), [&](int row) {
      for (int x = 0; x < width(level); ++x)
        build(level, row / width(level), x, row % width(level));
    });
  }
}

// Looks at every texel of the cell again, so that balls and discs are as small as can be.
void SheetTree::build(int level, int face, int x, int y) {
  const int texels = 1 << level;  // covered by a cell, fewer at the far border
  const int x0 = x * texels, x1 = std::min(x0 + texels, grid_.n()) - 1;
  const int y0 = y * texels, y1 = std::min(y0 + texels, grid_.n()) - 1;
  Cell& cell = cells_[at(level, face, x, y)];
  glm::dvec3 low(1e300), high(-1e300);
  const auto for_points = [&](auto&& visit) {
    for (int v = y0; v <= y1; ++v) {
      for (int u = x0; u <= x1; ++u) {
        const std::size_t texel = grid_.index({face, u, v});
        if (sheet_.present[texel] != 0)
          visit(sheet_.points[texel]);
        else
          cell.gaps = true;
      }
    }
  };
  for_points([&](const glm::dvec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  });
  if (low.x <= high.x) {
    cell.centre = 0.5 * (low + high);
    const auto corner = [&](int u, int v) {
      const std::size_t texel = grid_.index({face, u, v});
      return sheet_.present[texel] != 0 ? sheet_.points[texel] : cell.centre;
    };
    const glm::dvec3 across = glm::cross(corner(x1, y1) - corner(x0, y0), corner(x0, y1) - corner(x1, y0));
    const double length = glm::length(across);
    if (length > 0) cell.normal = across / length;
    cell.radius = 0;
    double least = 1e300, most = -1e300;
    for_points([&](const glm::dvec3& p) {
      const double off = glm::dot(p - cell.centre, cell.normal);
      least = std::min(least, off);
      most = std::max(most, off);
    });
    // The middle moves to the middle of the points' slab.
    if (length > 0) cell.centre += 0.5 * (least + most) * cell.normal;
    for_points([&](const glm::dvec3& p) { cell.radius = std::max(cell.radius, glm::distance(p, cell.centre)); });
    cell.thickness = length > 0 ? 0.5 * (most - least) : cell.radius;
  }
  // On a face the farthest direction from a cell's middle is at one of its corners.
  Range& range = ranges_[at(level, face, x, y)];
  const glm::dvec3 corners[] = {grid_.direction({face, x0, y0}), grid_.direction({face, x1, y0}),
                                grid_.direction({face, x0, y1}), grid_.direction({face, x1, y1})};
  range.axis = glm::normalize(corners[0] + corners[1] + corners[2] + corners[3]);
  for (const glm::dvec3& corner : corners)
    range.cosine = std::min(range.cosine, glm::dot(corner, range.axis));
  range.cosine -= 1e-12;  // rounding
  range.sine = std::sqrt(std::max(0.0, 1 - range.cosine * range.cosine));
}

double cone_a_cosine(const ConeA& cone, const std::vector<const SheetTree*>& trees, std::size_t& hint) {
  // The cosine of the angle at the apex between the axis and a point between the apex and the base.
  const auto score_in = [&](const Sheet& sheet, std::size_t texel) {
    if (sheet.present[texel] == 0) return kNone;
    const glm::dvec3 w = sheet.points[texel] - cone.apex;
    const double along = glm::dot(w, cone.axis);
    return along <= 0 || along > cone.height ? kNone : along / glm::length(w);
  };
  double best = 0;
  for (const SheetTree* tree : trees)
    best = std::max(best, score_in(tree->sheet(), hint));
  const double rounding = kRounding * cone.height;
  for (const SheetTree* tree : trees) {
    const auto cover = [&](std::size_t at, Candidate& c) {
      const SheetTree::Cell& cell = tree->cell(at);
      if (cell.radius < 0) return false;
      const glm::dvec3 w = cell.centre - cone.apex;
      c.along = glm::dot(w, cone.axis);
      if (c.along + cell.radius <= 0 || c.along - cell.radius > cone.height) return false;
      c.across = std::sqrt(std::max(0.0, glm::dot(w, w) - c.along * c.along));
      c.radius = cell.radius + rounding;
      c.thickness = cell.thickness + rounding;
      c.normal_along = glm::dot(cell.normal, cone.axis);
      // On the axis itself the direction across has no value; the cell counts by its radius there.
      if (c.across > rounding)
        c.normal_across = (glm::dot(cell.normal, w) - c.normal_along * c.along) / c.across;
      else
        c.normal_along = 0;
      return true;
    };
    best = search(*tree, best, hint, cover, [&](std::size_t texel) { return score_in(tree->sheet(), texel); });
  }
  return best;
}

double cone_b_inscribed(const ConeB& cone, const SheetTree& tree, std::size_t& hint) {
  const Sheet& sheet = tree.sheet();
  const auto breaks = [&](std::size_t texel) { return sheet.present[texel] == 0 || cone.breaks(sheet.points[texel]); };
  const auto score = [&](std::size_t texel) {
    return breaks(texel) ? glm::dot(tree.range(texel).axis, cone.axis) : kNone;
  };
  const auto cover = [&](std::size_t at, Candidate& c) {
    const SheetTree::Cell& cell = tree.cell(at);
    if (!cell.gaps &&
        std::abs(glm::dot(cell.centre, cone.normal) - cone.offset) + cell.reach(cone.normal) <= cone.half_width)
      return false;
    const SheetTree::Range& range = tree.range(at);  // a cap of the unit sphere, less than 60° wide
    c.along = glm::dot(range.axis, cone.axis);
    c.across = std::sqrt(std::max(0.0, 1 - c.along * c.along));
    c.radius = c.thickness = range.sine + kRounding;
    return true;
  };
  const double best = search(tree, std::max(score(hint), -1.0), hint, cover, score);
  return std::min(best, 1.0);
}

double cone_b_enclosing(const ConeB& cone, const Sheet& sheet, const CubeGrid& grid) {
  constexpr int kAround = 32;
  const glm::dvec3 side =
      glm::normalize(glm::cross(cone.axis, std::abs(cone.axis.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
  const glm::dvec3 up = glm::cross(cone.axis, side);
  const double step = 0.75 * grid.texel_angle(), cos_step = std::cos(step), sin_step = std::sin(step);
  double least = 1;
  for (int k = 0; k < kAround; ++k) {
    const double turn = 2 * std::numbers::pi * k / kAround;
    const glm::dvec3 across = std::cos(turn) * side + std::sin(turn) * up;
    double cosine = cos_step, sine = sin_step;
    while (cosine > 0) {
      const glm::dvec3 direction = cosine * cone.axis + sine * across;
      const std::size_t texel = grid.index(grid.nearest(direction));
      if (sheet.present[texel] == 0 || cone.breaks(sheet.points[texel])) break;
      least = std::min(least, cosine);
      const double next = cosine * cos_step - sine * sin_step;
      sine = sine * cos_step + cosine * sin_step;
      cosine = next;
    }
  }
  return std::max(least, 0.0);
}

}  // namespace pellucid::geocube
