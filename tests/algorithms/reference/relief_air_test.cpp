// Rays in air whose squared index is linear in height: parabolas.
#include "algorithms/reference/relief/relief_air.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace pellucid {
namespace {

constexpr double kGround2 = 1.0, kAbove2 = 1.0 + 0.008, kHeight = 0.5;

ReliefAir linear_air() {
  ReliefAir air;
  air.height_m = static_cast<float>(kHeight);
  air.size = {2, 2, 32};
  for (int z = 0; z < 32; ++z) {
    for (int i = 0; i < 4; ++i)
      air.index2.push_back(static_cast<float>(kGround2 + (kAbove2 - kGround2) * z / 31));
  }
  return air;
}

// With n² = a + b z, the ray through (0, z0) at the slope m there is z = z0 + m x + b x² / (4 n0² cos²), where
// n cos = n0 cos0 is kept.
double parabola(double x, double z0, double elevation) {
  const double b = (kAbove2 - kGround2) / kHeight, n2 = kGround2 + b * z0, cosine = std::cos(elevation);
  return z0 + std::tan(elevation) * x + b * x * x / (4 * n2 * cosine * cosine);
}

TEST(ReliefAir, BentRaysAreParabolas) {
  const ReliefAir air = linear_air();
  int met = 0, turned = 0;
  for (const double elevation_deg : {-0.5, -1.5, -3.0, -4.5, -6.0, -10.0, -30.0}) {
    const double elevation = glm::radians(elevation_deg);
    const ReliefRay ray{{0.0, 0.0, kHeight}, {std::cos(elevation), 0.0, std::sin(elevation)}, {0, 0}, {1, 1}};
    const BentRay bent = bend_through(air, ray, 0.01);
    EXPECT_NEAR(bent.position.z, parabola(bent.position.x, kHeight, elevation), 1e-3) << elevation_deg;
    const bool down = bent.end == BentRay::End::comes_down;
    (down ? met : turned) += 1;
    // Bent back to the height where it came from, it rises as steeply as it fell; a ray too steep for that goes on.
    const double lowest = kGround2 - kAbove2 * std::cos(elevation) * std::cos(elevation);
    EXPECT_EQ(down, lowest > 0) << elevation_deg;
    if (!down) {
      EXPECT_NEAR(bent.direction.z, -std::sin(elevation), 1e-3);
    }
  }
  EXPECT_GE(met, 3);
  EXPECT_GE(turned, 3);
}

}  // namespace
}  // namespace pellucid
