#include "algorithms/geocube/cones/bound_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace pellucid::geocube {
namespace {

constexpr double kNone = -2;  // below any cosine
constexpr std::size_t kNowhere = ~std::size_t{0};
constexpr float kRounding = 1e-6F;  // of single precision in some sums, as a share of the numbers' size

/// The patches of a cell's quarters.
struct Patches {
  FourVectors centre, first, second, third;
  Four size;
  explicit Patches(const Quarters& q)
      : centre(q.centre), first(q.edges[0]), second(q.edges[1]), third(q.edges[2]), size(q.size) {}
  // How far the points reach from the centre along a direction, at most.
  template <class Direction>
  Four reach(const Direction& direction) const {
    return stdx::abs(dot(first, direction)) + stdx::abs(dot(second, direction)) + stdx::abs(dot(third, direction));
  }
};

/// How far four patches lie outside a cone: their centres, and each of their points at least. Below 0: perhaps inside.
struct Outside {
  Four centre, least;
  void leave_out(const FourFlags& these) { stdx::where(these, least) = 1; }
};

/// A cone that holds no point so far, with a half-angle of 90° at most. Its axis passes through the cube's centre.
struct EmptyCone {
  glm::vec3 axis{0.0F};
  float apex = 0;  // its place along the axis
  float cosine = 0, sine = 1;

  void narrow(double c) {
    cosine = static_cast<float>(c);
    sine = static_cast<float>(std::sqrt(std::max(0.0, 1 - c * c)));
  }

  // How far each patch lies beyond the plane that touches the cone on the side of the patch's centre. A surface that
  // touches the cone lies along that plane, and so counts by its thickness, which falls with the square of its size.
  Outside outside(const Patches& patches) const {
    const FourVectors normal = touching_normal(patches.centre, axis, cosine, sine);
    const Four centre = dot(normal, patches.centre) + sine * apex;
    const Four rounding = kRounding * (patches.size + sine * std::abs(apex));
    return {centre, centre - patches.reach(normal) - rounding};
  }
};

// Depth first, the most promising patch first. `outside(cell, cone)` tells how far the cell's quarters lie outside the
// cone, `score(texel)` the cosine of a cone that the texel's point touches.
template <class OutsideOf, class Score>
double search(const PatchTree& tree, EmptyCone cone, double best, std::size_t& found, OutsideOf outside, Score score) {
  struct Waiting {
    float outside = 0;
    std::uint32_t cell = 0;
  };
  std::array<Waiting, 64> stack;  // three of each level and the roots
  std::size_t depth = 0;
  const auto push = [&](const Waiting& waiting, std::size_t base) {
    std::size_t i = depth++;
    for (; i > base && stack[i - 1].outside < waiting.outside; --i)
      stack[i] = stack[i - 1];
    stack[i] = waiting;
  };
  cone.narrow(best);
  for (const std::uint32_t root : tree.roots())
    push({0, root}, depth);
  while (depth > 0) {
    const std::uint32_t cell = stack[--depth].cell;
    const Outside out = outside(cell, cone);
    const FourFlags may_narrow = out.least < 0;
    if (stdx::none_of(may_narrow)) continue;
    const std::size_t base = depth;
    for (std::size_t k = 0; k < 4; ++k) {
      if (!may_narrow[k]) continue;
      const std::uint32_t child = tree.quarters(cell).child[k];
      if (!tree.lowest(cell)) {
        push({out.centre[k], child}, base);
        continue;
      }
      const double value = score(child);
      if (value <= best) continue;
      best = value;
      cone.narrow(best);
      found = child;
    }
  }
  return best;
}

// From a texel to the neighbour on its face that scores most, and on, for as long as one scores more. The cones of
// neighbouring texels touch the surface in neighbouring texels, so that a search which begins there has little left to
// do.
template <class Score>
double climb(int n, std::size_t& texel, Score score) {
  double best = score(texel);
  for (std::size_t from = kNowhere; from != texel;) {
    from = texel;
    const auto size = static_cast<std::size_t>(n), x = from % size, y = from / size % size;
    for (std::size_t k = 0; k < 9; ++k) {
      const std::size_t column = x + k % 3, row = y + k / 3;  // one more than the neighbour's
      if (k == 4 || column < 1 || column > size || row < 1 || row > size) continue;
      const std::size_t to = from + (row - 1) * size + column - 1 - y * size - x;
      const double value = score(to);
      if (value <= best) continue;
      best = value;
      texel = to;
    }
  }
  return best;
}

}  // namespace

double cone_a_cosine(const ConeA& cone, const std::vector<const SheetTree*>& trees, std::size_t& hint) {
  // The cosine of the angle at the apex between the axis and a point between the apex and the base.
  const auto score_in = [&](const Sheet& sheet, std::size_t texel) {
    if (sheet.present[texel] == 0) return kNone;
    const glm::dvec3 w = sheet.points[texel] - cone.apex;
    const double along = glm::dot(w, cone.axis);
    return along <= 0 || along > cone.height ? kNone : along / glm::length(w);
  };
  double best = 0;
  for (const SheetTree* surface : trees)
    best = std::max(best, climb(surface->tree.n(), hint, [&](std::size_t at) { return score_in(surface->sheet, at); }));
  const EmptyCone empty{.axis = glm::vec3(cone.axis), .apex = static_cast<float>(glm::dot(cone.apex, cone.axis))};
  const auto height = static_cast<float>(cone.height);
  for (const SheetTree* surface : trees) {
    const auto outside = [&](std::uint32_t cell, const EmptyCone& narrowest) {
      const Patches patches(surface->tree.quarters(cell));
      const Four along = dot(patches.centre, narrowest.axis) - narrowest.apex;
      const Four reach = patches.reach(narrowest.axis) + kRounding * (patches.size + height);
      Outside result = narrowest.outside(patches);
      result.leave_out(patches.size < 0 || along + reach < 0 || along - reach > height);
      return result;
    };
    best = search(surface->tree, empty, best, hint, outside,
                  [&](std::size_t texel) { return score_in(surface->sheet, texel); });
  }
  return best;
}

double cone_b_inscribed(const ConeB& cone, const SheetTree& surface, const SheetTree& directions, std::size_t& hint) {
  const Sheet& sheet = surface.sheet;
  const auto score = [&](std::size_t texel) {
    const bool breaks = sheet.present[texel] == 0 || cone.breaks(sheet.points[texel]);
    return breaks ? glm::dot(directions.sheet.points[texel], cone.axis) : kNone;
  };
  const EmptyCone empty{.axis = glm::vec3(cone.axis)};
  const glm::vec3 normal(cone.normal);
  const auto offset = static_cast<float>(cone.offset), half_width = static_cast<float>(cone.half_width);
  const auto outside = [&](std::uint32_t cell, const EmptyCone& narrowest) {
    const Quarters& quarters = surface.tree.quarters(cell);
    const Patches patches(quarters);
    const Four rounding = kRounding * (patches.size + std::abs(offset));
    const Four off = stdx::abs(dot(patches.centre, normal) - offset) + patches.reach(normal) + rounding;
    const FourFlags keeps = off + Four(quarters.gap) < half_width;
    if (stdx::all_of(keeps)) return Outside{1, 1};
    const Patches around(directions.tree.quarters(cell));
    Outside result = narrowest.outside(around);
    result.leave_out(keeps || around.size < 0);
    return result;
  };
  const double best = search(surface.tree, empty, std::max(score(hint), 0.0), hint, outside, score);
  return std::min(best, 1.0);
}

Sheet unit_sphere(const CubeGrid& grid) {
  Sheet sheet;
  sheet.present.assign(grid.texels(), 1);
  for (std::size_t i = 0; i < grid.texels(); ++i)
    sheet.points.push_back(grid.direction(i));
  return sheet;
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
