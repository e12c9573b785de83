#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/geocube/search.hpp"
#include "tests/algorithms/geocube/geocube_solids.hpp"

namespace pellucid::geocube {
namespace {

using test::ellipsoid_radius;
using test::make_radial;
using test::random_direction;

struct Errors {
  double point = 0;      // mean, in diagonals
  double angle = 0;      // mean of the normal's, in radians
  double steps = 0;      // mean
  double bounded = 0;    // share
  double far_early = 0;  // share of rays that end more than 2 % of the diagonal before the surface
};

// Refracted rays through an ellipsoid of these axes, by the geocube and by the closed form.
Errors trace(const glm::dvec3& axes, const glm::dvec3& center, int resolution, SearchOptions search,
             CubeOptions options = {}) {
  const Solid solid(make_radial([&](const glm::dvec3& u) { return ellipsoid_radius(u, axes); }, 72));
  options.resolution = resolution;
  const CubeSet set = build_cubes(solid, std::vector{center}, options);
  const CubeMaps maps(set);
  search.min_step = static_cast<float>(2e-3 * set.diagonal);
  Errors sum;
  Random random(12);
  constexpr int kRays = 2000;
  for (int i = 0; i < kRays; ++i) {
    const glm::dvec3 u = random_direction(random), p = ellipsoid_radius(u, axes) * u;
    const glm::dvec3 n = glm::normalize(p / (axes * axes));
    const glm::dvec3 around = random_direction(random);
    const glm::dvec3 incident = glm::dot(around, n) > 0 ? -around : around;
    const glm::dvec3 h = glm::normalize(glm::refract(incident, n, 1 / options.ior));
    // |(p + t·h)/axes| = 1
    const glm::dvec3 sp = p / axes, sh = h / axes;
    const double t = -2 * glm::dot(sp, sh) / glm::dot(sh, sh);
    const glm::dvec3 exit = p + t * h, exit_normal = glm::normalize(exit / (axes * axes));
    const Exit found = find_exit(maps, glm::vec3(p), glm::vec3(n), glm::vec3(h), 0, search);
    sum.point += glm::distance(glm::dvec3(found.point), exit) / set.diagonal / kRays;
    sum.angle += std::acos(std::min(1.0, glm::dot(glm::dvec3(found.normal), exit_normal))) / kRays;
    sum.steps += static_cast<double>(found.steps) / kRays;
    sum.bounded += found.bounded ? 1.0 / kRays : 0;
    sum.far_early += static_cast<double>(found.length) < t - 0.02 * set.diagonal ? 1.0 / kRays : 0;
  }
  return sum;
}

TEST(GeocubeSearch, FindsTheExitOfAnOffCentreSphere) {
  const Errors at64 = trace(glm::dvec3(1.0), {0.35, -0.2, 0.15}, 64, {});
  EXPECT_LT(at64.point, 0.002);
  EXPECT_LT(at64.angle, 0.02);
  EXPECT_LT(at64.far_early, 0.005);
  const Errors at16 = trace(glm::dvec3(1.0), {0.35, -0.2, 0.15}, 16, {});
  EXPECT_LT(at64.point, 0.3 * at16.point);
}

TEST(GeocubeSearch, ErrorsOfAnEllipsoidFallAtLeastWithTheTexel) {
  const glm::dvec3 axes(1.0, 0.5, 0.75), center(0.3, 0.1, -0.2);
  SearchOptions search;
  search.iterations = 32;
  double last = 1;
  for (const int n : {8, 16, 32, 64}) {
    const Errors errors = trace(axes, center, n, search);
    EXPECT_LT(errors.point, 0.55 * last) << n;
    if (n == 64) {
      EXPECT_LT(errors.point, 0.002);
    }
    EXPECT_LT(errors.bounded, 0.01);
    last = errors.point;
  }
}

// A ball of radius 1 seen from its middle: sphere D is the ball itself.
struct BallMaps {
  float distance = 1;  // as rounding leaves it
  int count() const { return 1; }
  glm::vec3 center(int /*cube*/) const { return glm::vec3(0.0F); }
  float sphere(int /*cube*/) const { return 1.0F; }
  CubeSample fetch(int /*cube*/, const glm::vec3& direction) const {
    return {glm::vec4(distance, 1, 1, 0), glm::vec4(glm::normalize(direction), 0)};
  }
};

// Sphere D leads to the exit itself, where rounding decides which side a point lies on: that must not send a ray back
// to the middle of its way.
TEST(GeocubeSearch, RoundingAtTheExitMovesItByNoMoreThanRounding) {
  SearchOptions search;
  search.min_step = 0.005F;
  for (const float distance : {1.0F - 5e-7F, 1.0F - 1e-7F, 1.0F, 1.0F + 1e-7F}) {
    Random random(5);
    double worst = 0;
    for (int i = 0; i < 4000; ++i) {
      const glm::dvec3 n = random_direction(random), around = random_direction(random);
      const glm::dvec3 incident = glm::dot(around, n) > 0 ? -around : around;
      const glm::dvec3 h = glm::normalize(glm::refract(incident, n, 1 / 1.5));
      const Exit found = find_exit(BallMaps{distance}, glm::vec3(n), glm::vec3(n), glm::vec3(h), 0, search);
      worst = std::max(worst, std::abs(static_cast<double>(found.length) + 2 * glm::dot(n, h)));
    }
    EXPECT_LT(worst, 2e-5) << distance;
  }
}

TEST(GeocubeSearch, EachConeSavesSteps) {
  const glm::dvec3 axes(1.0, 0.6, 0.8), center(0.2, 0.1, -0.2);
  SearchOptions search;
  search.iterations = 2000;
  CubeOptions options;
  const Errors all = trace(axes, center, 32, search, options);
  options.use_a = options.use_b = options.use_c = options.use_d = false;
  const Errors none = trace(axes, center, 32, search, options);
  EXPECT_LT(all.steps, 10);
  EXPECT_GT(none.steps, 60) << "with δ alone";
  EXPECT_LT(none.point, 0.002);
  EXPECT_LT(all.point, 0.002);
  options = {};
  options.use_a = false;
  options.use_d = false;
  EXPECT_GT(trace(axes, center, 32, search, options).steps, all.steps);
}

TEST(GeocubeSearch, TheBoundStopsAtASurfacePoint) {
  SearchOptions search;
  search.iterations = 1;
  const Errors errors = trace(glm::dvec3(1.0), {0.3, 0.1, 0}, 32, search);
  EXPECT_GT(errors.bounded, 0.05);
}

}  // namespace
}  // namespace pellucid::geocube
