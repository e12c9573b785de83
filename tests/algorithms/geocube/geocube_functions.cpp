#include <cmath>
#include <cstddef>
#include <numbers>

#include <gtest/gtest.h>

#include "algorithms/geocube/search.hpp"
#include "algorithms/scene/noise.hpp"
#include "tests/algorithms/geocube/geocube_solids.hpp"

namespace pellucid::geocube {
namespace {

using test::random_direction;

// How far the ray from p runs inside a convex-in-the-ray region, by bisection after small steps.
template <class Inside>
double run(const glm::dvec3& p, const glm::dvec3& h, double most, Inside inside) {
  constexpr int kSteps = 4000;
  for (int i = 1; i <= kSteps; ++i) {
    double high = most * i / kSteps;
    if (inside(p + high * h)) continue;
    double low = most * (i - 1) / kSteps;
    for (int k = 0; k < 50; ++k)
      (inside(p + 0.5 * (low + high) * h) ? low : high) = 0.5 * (low + high);
    return low;
  }
  return most;
}

bool in_cone(const glm::dvec3& x, double mu) {
  return x.z >= mu * glm::length(x);
}

TEST(GeocubeFunctions, ConeWallIsWhereARayMeetsTheCone) {
  Random random(3);
  int met = 0;
  for (int i = 0; i < 2000; ++i) {
    const double mu = static_cast<double>(random.range(0.02F, 0.999F));
    const glm::dvec3 h = random_direction(random);
    const double expected = run({0, 0, 1}, h, 40, [&](const glm::dvec3& x) { return in_cone(x, mu); });
    const double found = static_cast<double>(cone_wall(static_cast<float>(mu), static_cast<float>(-h.z)));
    if (expected >= 40) {
      EXPECT_GT(found, 39.9);
      continue;
    }
    ++met;
    EXPECT_NEAR(found, expected, 2e-3 * expected * (1 + expected)) << "mu " << mu << " h.z " << h.z;
  }
  EXPECT_GT(met, 800);
}

TEST(GeocubeFunctions, ConeStepStaysInTheConeAndUnderItsBase) {
  Random random(4);
  int compared = 0;
  for (int i = 0; i < 4000; ++i) {
    const double mu = static_cast<double>(random.range(0.1F, 0.999F)), f = static_cast<double>(random.next());
    const glm::dvec3 h = random_direction(random);
    glm::dvec3 n = glm::normalize(glm::dvec3(0, 0, 1.2) + 0.8 * random_direction(random));
    // A base that cuts all of the cone's generators, as one in a tangent plane does.
    const double sine = std::sqrt(1 - mu * mu);
    if (mu * n.z - sine * std::hypot(n.x, n.y) <= 0.05) continue;
    const glm::dvec3 base(0, 0, 1), p(0, 0, 1 - f);
    const double expected =
        run(p, h, 60, [&](const glm::dvec3& x) { return in_cone(x, mu) && glm::dot(x - base, n) <= 0; });
    const double found = static_cast<double>(cone_step(static_cast<float>(f), static_cast<float>(h.z),
                                                       static_cast<float>(glm::dot(h, n)), static_cast<float>(n.z),
                                                       static_cast<float>(mu)));
    ++compared;
    EXPECT_NEAR(found, expected, 2e-3 * (0.02 + expected)) << "mu " << mu << " f " << f << " h.z " << h.z;
  }
  EXPECT_GT(compared, 1000);
}

TEST(GeocubeFunctions, SphereStepReachesTheSphere) {
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const double f = static_cast<double>(random.next());
    const glm::dvec3 v = random_direction(random), h = random_direction(random);
    const double expected = run(f * v, h, 2.5, [](const glm::dvec3& x) { return glm::dot(x, x) <= 1; });
    EXPECT_NEAR(static_cast<double>(sphere_step(static_cast<float>(f), static_cast<float>(glm::dot(h, v)))), expected,
                1e-5);
  }
}

TEST(GeocubeFunctions, CubeMapCoordinatesComeBackAndJoinAtEdges) {
  const CubeGrid grid(7);
  for (std::size_t i = 0; i < grid.texels(); ++i) {
    EXPECT_EQ(grid.index(grid.nearest(grid.direction(i))), i);
    const CubeGrid::Sample at = grid.sample(grid.direction(i));
    double share = 0;
    for (std::size_t k = 0; k < 4; ++k)
      share += at.index[k] == i ? at.weight[k] : 0;
    EXPECT_NEAR(share, 1, 1e-9);
  }
  // A smooth function is continuous across edges and corners, and near itself everywhere.
  const auto value = [&](const glm::dvec3& d) {
    const CubeGrid::Sample at = grid.sample(d);
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const glm::dvec3 t = grid.direction(at.index[k]);
      sum += at.weight[k] * (t.x + 0.5 * t.y - 0.3 * t.z);
    }
    return sum;
  };
  Random random(6);
  for (int i = 0; i < 3000; ++i) {
    glm::dvec3 d = random_direction(random);
    const int axis = i % 3;
    d[axis] = d[(axis + 1) % 3] * (random.next() < 0.5F ? 1 : -1);  // on an edge, or beyond it
    const glm::dvec3 across = 1e-7 * random_direction(random);
    EXPECT_NEAR(value(d + across), value(d - across), 1e-5);
    EXPECT_NEAR(value(d), (d.x + 0.5 * d.y - 0.3 * d.z) / glm::length(d), 0.06);
  }
}

}  // namespace
}  // namespace pellucid::geocube
