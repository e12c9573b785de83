#include "algorithms/geocube/cones/bound_search.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
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

/// A cone that holds no point so far, with a half-angle of 90° at most. Its axis passes through the cube's centre.
struct EmptyCone {
  glm::vec3 axis{0.0F};
  float apex = 0;  // its place along the axis
  float cosine = 0, sine = 1;

  void narrow(double c) {
    cosine = static_cast<float>(c);
    sine = static_cast<float>(std::sqrt(std::max(0.0, 1 - c * c)));
  }

  // How far the points of each patch lie at least beyond the plane that touches the cone on the side of the patch's
  // centre; below 0: perhaps inside. A surface that touches the cone lies along that plane, and so counts by its
  // thickness, which falls with the square of its size.
  Four outside(const Patches& patches) const {
    const FourVectors normal = touching_normal(patches.centre, axis, cosine, sine);
    const Four rounding = kRounding * (patches.size + sine * std::abs(apex));
    return dot(normal, patches.centre) + sine * apex - patches.reach(normal) - rounding;
  }
};

// `outside(cell, cone)` tells how far the cell's quarters lie outside the cone, `score(texel)` the cosine of a cone
// that the texel's point touches. A search begins with a `best` that little or nothing betters, so that the cells'
// order is of no matter. They are taken by batches: no branch waits for a result, and the processor works at several
// cells at a time.
template <class OutsideOf, class Score>
double search(const PatchTree& tree, EmptyCone cone, double best, std::size_t& found, OutsideOf outside, Score score) {
  constexpr std::size_t kBatch = 16;
  std::array<std::uint32_t, 1024> waiting;  // a batch leaves three times its number at most, once for each level
  std::array<std::uint32_t, kBatch> cells;
  std::array<unsigned, kBatch> inside;
  std::size_t count = tree.roots().size();
  std::ranges::copy(tree.roots(), waiting.begin());
  cone.narrow(best);
  while (count > 0) {
    const std::size_t batch = std::min(count, kBatch);
    count -= batch;
    assert(count + 4 * batch <= waiting.size());
    for (std::size_t i = 0; i < batch; ++i) {
      cells[i] = waiting[count + i];
      inside[i] = bits_of(outside(cells[i], cone) < 0);
    }
    for (std::size_t i = 0; i < batch; ++i) {
      const Quarters& quarters = tree.quarters(cells[i]);
      if (!tree.lowest(cells[i])) {
        for (std::size_t k = 0; k < 4; ++k) {
          waiting[count] = quarters.child[k];
          count += inside[i] >> k & 1U;
        }
        continue;
      }
      for (unsigned left = inside[i]; left != 0; left &= left - 1) {
        const std::uint32_t texel = quarters.child[static_cast<std::size_t>(std::countr_zero(left))];
        const double value = score(texel);
        if (value <= best) continue;
        best = value;
        cone.narrow(best);
        found = texel;
      }
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
      Four result = narrowest.outside(patches);
      stdx::where(patches.size < 0 || along + reach < 0 || along - reach > height, result) = 1;
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
    const Patches around(directions.tree.quarters(cell));
    Four result = narrowest.outside(around);
    stdx::where(keeps || around.size < 0, result) = 1;
    return result;
  };
  const double best =
      search(surface.tree, empty, std::max(climb(surface.tree.n(), hint, score), 0.0), hint, outside, score);
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
