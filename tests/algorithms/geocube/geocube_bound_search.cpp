// The searches of cones A, B and C against the comparison of all with all.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/geocube/cones/bound_search.hpp"
#include "algorithms/geocube/cones/triangle_tree.hpp"
#include "algorithms/scene/noise.hpp"
#include "tests/algorithms/geocube/geocube_solids.hpp"

namespace pellucid::geocube {
namespace {

// A surface about a centre as close as a thousandth to it: `rough` makes each texel's distance a number of its own,
// `holes` leaves some out. Rows of texels on a flat face all but tie.
Sheet box_about(const CubeGrid& grid, double nearest, float rough, float holes, std::uint32_t seed) {
  Random random(seed);
  const glm::dvec3 low(-nearest, -0.4, -0.9), high(1.1, 0.8, 0.7);
  Sheet sheet;
  for (std::size_t i = 0; i < grid.texels(); ++i) {
    const glm::dvec3 v = grid.direction(i);
    double distance = 1e9;
    for (int k = 0; k < 3; ++k) {
      if (v[k] != 0) distance = std::min(distance, (v[k] > 0 ? high[k] : low[k]) / v[k]);
    }
    sheet.points.push_back(distance * (1 + random.range(-rough, rough)) * v);
    sheet.present.push_back(random.next() < holes ? 0 : 1);
  }
  return sheet;
}

struct Surface {
  double nearest = 0.5;
  float rough = 0, holes = 0;
};
const std::vector<Surface> kSurfaces{{0.5, 0, 0}, {1e-3, 0, 0}, {0.5, 0.3F, 0}, {0.02, 0.01F, 0.1F}, {0.5, 0, 0.6F}};

TEST(GeocubeBoundSearch, ConeAIsThatOfTheFullComparisonToTheLastBit) {
  const CubeGrid grid(13);
  for (const Surface& surface : kSurfaces) {
    const SheetTree near(grid, box_about(grid, surface.nearest, surface.rough, surface.holes, 1));
    const SheetTree far(grid, box_about(grid, 2, surface.rough, 0.5F, 2));
    std::size_t hint = 0;
    for (std::size_t i = 0; i < grid.texels(); i += 3) {
      if (near.sheet.present[i] == 0) continue;
      const glm::dvec3 apex = near.sheet.points[i], axis = -grid.direction(i);
      const double height = i % 2 == 0 ? glm::length(apex) : 0.4 * glm::length(apex);
      double expected = 0;
      for (const SheetTree* each : {&near, &far}) {
        for (std::size_t k = 0; k < grid.texels(); ++k) {
          const glm::dvec3 w = each->sheet.points[k] - apex;
          const double along = glm::dot(w, axis);
          if (each->sheet.present[k] != 0 && along > 0 && along <= height)
            expected = std::max(expected, along / glm::length(w));
        }
      }
      EXPECT_EQ(cone_a_cosine({apex, axis, height}, {&near, &far}, hint), expected) << surface.nearest << ' ' << i;
    }
  }
}

TEST(GeocubeBoundSearch, ConeBIsThatOfTheFullComparisonToTheLastBit) {
  const CubeGrid grid(13);
  const SheetTree directions(grid, unit_sphere(grid));
  Random random(3);
  for (const Surface& surface : kSurfaces) {
    const SheetTree tree(grid, box_about(grid, surface.nearest, surface.rough, surface.holes, 1));
    std::size_t hint = 0;
    for (std::size_t i = 0; i < grid.texels(); i += 3) {
      if (tree.sheet.present[i] == 0) continue;
      const glm::dvec3 v = grid.direction(i), s = tree.sheet.points[i];
      const glm::dvec3 normal = i % 2 == 0 ? test::random_direction(random) : v;
      const ConeB cone{v, normal, glm::dot(s, normal), random.range(0.001F, 0.3F)};
      double expected = 0;
      for (std::size_t k = 0; k < grid.texels(); ++k) {
        if (tree.sheet.present[k] == 0 || cone.breaks(tree.sheet.points[k]))
          expected = std::max(expected, std::min(glm::dot(grid.direction(k), v), 1.0));
      }
      EXPECT_EQ(cone_b_inscribed(cone, tree, directions, hint), expected) << surface.nearest << ' ' << i;
    }
  }
}

TEST(GeocubeBoundSearch, ConeCAndTheNearestPointAreThoseOfAllTriangles) {
  Random random(4);
  for (const int kind : {0, 1}) {  // a smooth mesh, and triangles without order
    std::vector<glm::dvec3> positions;
    std::vector<glm::uvec3> triangles;
    if (kind == 0) {
      const Mesh star = make_star({}, 12);
      positions.assign(star.positions.begin(), star.positions.end());
      triangles = star.triangles;
    } else {
      for (std::uint32_t t = 0; t < 300; ++t) {
        const glm::dvec3 at(random.range(-1, 1), random.range(-1, 1), random.range(-1, 1));
        for (int c = 0; c < 3; ++c)
          positions.push_back(at + 0.3 * random.next() * test::random_direction(random));
        triangles.emplace_back(3 * t, 3 * t + 1, 3 * t + 2);
      }
    }
    const TriangleTree tree(positions, triangles);
    std::uint32_t hint = kNoTriangle;
    for (int query = 0; query < 300; ++query) {
      // Half of the apexes lie on a triangle, which the cone looks away from.
      const auto own = static_cast<std::uint32_t>(random.below(static_cast<int>(triangles.size())));
      const auto t = tree.corners(own);
      const bool on_surface = query % 2 == 0;
      const glm::dvec3 inwards = -glm::normalize(glm::cross(t[1] - t[0], t[2] - t[0]));
      const double sine = random.range(0.05F, 1);
      const Cone cone{on_surface ? (t[0] + t[1] + t[2]) / 3.0 : 1.5 * random.next() * test::random_direction(random),
                      on_surface ? inwards : test::random_direction(random), std::sqrt(1 - sine * sine), sine};
      double in_cone = std::numeric_limits<double>::infinity(), anywhere = in_cone;
      for (std::uint32_t k = 0; k < triangles.size(); ++k) {
        auto corners = tree.corners(k);
        if (!on_surface || k != own) in_cone = std::min(in_cone, distance_in_cone(cone, corners));
        for (glm::dvec3& corner : corners)
          corner -= cone.apex;
        anywhere = std::min(anywhere, distance_to_triangle(corners));
      }
      const Nearest found = tree.nearest_in_cone(cone, on_surface ? own : kNoTriangle, hint);
      EXPECT_EQ(found.distance, in_cone) << kind << ' ' << query;
      EXPECT_EQ(tree.nearest(cone.apex).distance, anywhere) << kind << ' ' << query;
      hint = found.triangle;
    }
  }
}

}  // namespace
}  // namespace pellucid::geocube
