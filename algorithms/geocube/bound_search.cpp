#include "algorithms/geocube/bound_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace pellucid::geocube {
namespace {

constexpr double kNone = -2;  // below any cosine
constexpr double kRounding = 1e-9;

/// The widest cone so far that still holds nothing, about the axis.
struct Narrowest {
  double cosine = -1, sine = 0;
  explicit Narrowest(double c) : cosine(c), sine(std::sqrt(std::max(0.0, 1 - c * c))) {}
};

/// What a cell covers, seen from the cone's apex: a ball, by its centre's place along and across the axis.
struct Candidate {
  double along = 0, across = 0, reach = -1;
  double outside = 0;  // how far it was outside the cone
  int level = 0, face = 0, x = 0, y = 0;

  // False when it lies outside the cone and so cannot narrow it.
  bool meets(const Narrowest& cone) const {
    if (cone.cosine > 0 && along * cone.cosine + across * cone.sine < 0)
      return along * along + across * across < reach * reach;
    return across * cone.cosine - along * cone.sine < reach;
  }
};

// Depth first, the most promising cell first. `cover(index, candidate)` tells what a cell covers, false if nothing of
// interest; `score(texel)` is the cosine of what narrows the cone; `slack` is the share of 1 − cos that may be missed.
template <class Cover, class Score>
double search(const SheetTree& tree, double best, std::size_t& found, double slack, Cover cover, Score score) {
  std::array<Candidate, 96> stack;
  std::size_t depth = 0;
  Narrowest cone(best + slack * (1 - best));
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
        cone = Narrowest(best + slack * (1 - best));
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
    if (sheet_.present[i] != 0) cells_[i] = {sheet_.points[i], 0, false};
    cells_[i].gaps = sheet_.present[i] == 0;
    ranges_[i].axis = grid.direction(i);
  }
  for (int level = 1; level < levels(); ++level) {
    const int below = width(level - 1);
    const int texels = 1 << level;  // covered by a cell, fewer at the far border
    for (int face = 0; face < 6; ++face) {
      for (int y = 0; y < width(level); ++y) {
        for (int x = 0; x < width(level); ++x) {
          Cell& cell = cells_[at(level, face, x, y)];
          glm::dvec3 low(1e300), high(-1e300);
          for (int k = 0; k < 4; ++k) {
            if (2 * x + k % 2 >= below || 2 * y + k / 2 >= below) continue;
            const Cell& part = cells_[at(level - 1, face, 2 * x + k % 2, 2 * y + k / 2)];
            cell.gaps = cell.gaps || part.gaps;
            if (part.radius < 0) continue;
            low = glm::min(low, part.centre - part.radius);
            high = glm::max(high, part.centre + part.radius);
          }
          if (low.x <= high.x) {
            cell.centre = 0.5 * (low + high);
            for (int k = 0; k < 4; ++k) {
              if (2 * x + k % 2 >= below || 2 * y + k / 2 >= below) continue;
              const Cell& part = cells_[at(level - 1, face, 2 * x + k % 2, 2 * y + k / 2)];
              if (part.radius < 0) continue;
              cell.radius = std::max(cell.radius, glm::distance(cell.centre, part.centre) + part.radius);
            }
          }
          // On a face the farthest direction from a cell's middle is at one of its corners.
          const int x0 = x * texels, x1 = std::min(x0 + texels, grid.n()) - 1;
          const int y0 = y * texels, y1 = std::min(y0 + texels, grid.n()) - 1;
          Range& range = ranges_[at(level, face, x, y)];
          const glm::dvec3 corners[] = {grid.direction({face, x0, y0}), grid.direction({face, x1, y0}),
                                        grid.direction({face, x0, y1}), grid.direction({face, x1, y1})};
          range.axis = glm::normalize(corners[0] + corners[1] + corners[2] + corners[3]);
          for (const glm::dvec3& corner : corners)
            range.cosine = std::min(range.cosine, glm::dot(corner, range.axis));
          range.cosine -= 1e-12;  // rounding
          range.sine = std::sqrt(std::max(0.0, 1 - range.cosine * range.cosine));
        }
      }
    }
  }
}

void SheetTree::include(const SheetTree& other) {
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    Cell& mine = cells_[i];
    const Cell& theirs = other.cells_[i];
    if (theirs.radius < 0) continue;
    if (mine.radius < 0) {
      mine.centre = theirs.centre;
      mine.radius = theirs.radius;
      continue;
    }
    mine.radius = std::max(mine.radius, glm::distance(mine.centre, theirs.centre) + theirs.radius);
  }
}

double cone_a_cosine(const ConeA& cone, const SheetTree& tree, const std::vector<const Sheet*>& sheets,
                     std::size_t& hint) {
  // The cosine of the angle at the apex between the axis and a point between the apex and the base.
  const auto score = [&](std::size_t texel) {
    double best = kNone;
    for (const Sheet* sheet : sheets) {
      if (sheet->present[texel] == 0) continue;
      const glm::dvec3 w = sheet->points[texel] - cone.apex;
      const double along = glm::dot(w, cone.axis);
      if (along <= 0 || along > cone.height) continue;
      best = std::max(best, along / glm::length(w));
    }
    return best;
  };
  const auto cover = [&](std::size_t at, Candidate& c) {
    const SheetTree::Cell& cell = tree.cell(at);
    if (cell.radius < 0) return false;
    const glm::dvec3 w = cell.centre - cone.apex;
    c.along = glm::dot(w, cone.axis);
    if (c.along + cell.radius <= 0 || c.along - cell.radius > cone.height) return false;
    c.across = std::sqrt(std::max(0.0, glm::dot(w, w) - c.along * c.along));
    c.reach = cell.radius + kRounding * cone.height;
    return true;
  };
  const double first = std::max(0.0, score(hint));
  const double best = search(tree, first, hint, kSlack, cover, score);
  return best > 0 ? best + kSlack * (1 - best) : 0;
}

double cone_b_inscribed(const ConeB& cone, const SheetTree& tree, std::size_t& hint) {
  const Sheet& sheet = tree.sheet();
  const auto breaks = [&](std::size_t texel) { return sheet.present[texel] == 0 || cone.breaks(sheet.points[texel]); };
  const auto score = [&](std::size_t texel) {
    return breaks(texel) ? glm::dot(tree.range(texel).axis, cone.axis) : kNone;
  };
  const auto cover = [&](std::size_t at, Candidate& c) {
    const SheetTree::Cell& cell = tree.cell(at);
    if (!cell.gaps && std::abs(glm::dot(cell.centre, cone.normal) - cone.offset) + cell.radius <= cone.half_width)
      return false;
    const SheetTree::Range& range = tree.range(at);  // a cap of the unit sphere, less than 60° wide
    c.along = glm::dot(range.axis, cone.axis);
    c.across = std::sqrt(std::max(0.0, 1 - c.along * c.along));
    c.reach = range.sine + kRounding;
    return true;
  };
  const double best = search(tree, std::max(score(hint), -1.0), hint, 0.0, cover, score);
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
