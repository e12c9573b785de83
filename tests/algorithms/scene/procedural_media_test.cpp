#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/scene/shapes/bounds.hpp"
#include "algorithms/scene/shapes/procedural.hpp"

/// Smoke, water, cones of light and reliefs.
namespace pellucid {
namespace {

double sum(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

template <class F>
void for_each_voxel(const glm::ivec3& size, const std::vector<float>& density, F visit) {
  ASSERT_EQ(density.size(), static_cast<std::size_t>(size.x * size.y * size.z));
  std::size_t i = 0;
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x)
        visit(glm::ivec3(x, y, z), density[i++]);
    }
  }
}

TEST(ProceduralSmoke, IsTheSameForASeedAndEndsBeforeTheFaces) {
  const glm::ivec3 size(24, 32, 20);
  const auto smoke = make_smoke_density(size, SmokeOptions{});
  EXPECT_EQ(smoke, make_smoke_density(size, SmokeOptions{}));
  SmokeOptions other;
  other.seed = 2;
  EXPECT_NE(smoke, make_smoke_density(size, other));
  EXPECT_NEAR(sum(smoke), 200.0, 150.0);
  for_each_voxel(size, smoke, [&](const glm::ivec3& p, float v) {
    ASSERT_TRUE(v >= 0.0F && v <= 1.0F);
    const bool outermost = glm::any(glm::equal(p, glm::ivec3(0))) || glm::any(glm::equal(p, size - 1));
    if (outermost) {
      ASSERT_EQ(v, 0.0F) << p.x << ", " << p.y << ", " << p.z;
    }
  });
}

TEST(ProceduralSmoke, RisesFromTheMiddleOfTheBottomAndWidens) {
  const glm::ivec3 size(48);
  SmokeOptions even;
  even.contrast = 0;
  even.swirl = 0;
  // Mean squared distance from the axis in a layer.
  double spread_low = 0, spread_high = 0, low = 0, high = 0;
  for_each_voxel(size, make_smoke_density(size, even), [&](const glm::ivec3& p, float v) {
    const double x = (p.x + 0.5) / 48 - 0.5, z = (p.z + 0.5) / 48 - 0.5;
    const double density = static_cast<double>(v);
    if (p.y == 8) {
      low += density;
      spread_low += density * (x * x + z * z);
    }
    if (p.y == 28) {
      high += density;
      spread_high += density * (x * x + z * z);
    }
  });
  // A plume exp(−r²/R²) has the mean square R².
  EXPECT_NEAR(std::sqrt(spread_low / low), 0.06 + 0.16 * 8.5 / 48, 0.004);
  EXPECT_GT(spread_high / high, 2 * spread_low / low);
}

TEST(ProceduralSmoke, OneVoxelAxesAreNoReasonForNothing) {
  EXPECT_GT(sum(make_smoke_density({24, 24, 1}, SmokeOptions{})), 1.0);
  EXPECT_GT(sum(make_smoke_density({1, 1, 1}, SmokeOptions{})), 0.01);
}

TEST(ProceduralWater, IsFullToItsLevelAndDenserWithDepth) {
  const glm::ivec3 size(16, 40, 12);
  WaterOptions still;
  still.contrast = 0;
  still.wave = 0;
  still.level = 0.75F;  // 30 voxels
  still.depth_gradient = 0.4F;
  for_each_voxel(size, make_water_density(size, still), [&](const glm::ivec3& p, float v) {
    const float depth = 1.0F - (static_cast<float>(p.y) + 0.5F) / 30.0F;
    ASSERT_NEAR(v, p.y < 30 ? 0.6F + 0.4F * depth : 0.0F, 1e-5F) << p.y;
  });
}

TEST(ProceduralWater, WavesMoveTheSurfaceButNotTheVolume) {
  const glm::ivec3 size(64, 128, 64);
  WaterOptions waves;
  waves.contrast = 0;
  waves.depth_gradient = 0;
  waves.level = 0.6F;
  waves.wave = 0.1F;
  const auto water = make_water_density(size, waves);
  std::vector<double> height(64 * 64, 0.0);
  for_each_voxel(size, water, [&](const glm::ivec3& p, float v) {
    ASSERT_TRUE(v >= 0.0F && v <= 1.0F);
    height[static_cast<std::size_t>(p.z * 64 + p.x)] += static_cast<double>(v) / 128;
  });
  const auto [low, high] = std::minmax_element(height.begin(), height.end());
  EXPECT_LT(*low, 0.54);
  EXPECT_GE(*low, 0.499);
  EXPECT_GT(*high, 0.66);
  EXPECT_LE(*high, 0.701);
  EXPECT_NEAR(std::accumulate(height.begin(), height.end(), 0.0) / (64 * 64), 0.6, 0.03);
}

TEST(ProceduralWater, IsTheSameForASeedAndNearlyHomogeneous) {
  const glm::ivec3 size(24);
  WaterOptions full;
  full.level = 1;
  full.wave = 0;
  full.depth_gradient = 0;
  const auto water = make_water_density(size, full);
  EXPECT_EQ(water, make_water_density(size, full));
  const auto [low, high] = std::minmax_element(water.begin(), water.end());
  EXPECT_GE(*low, 0.7999F);
  EXPECT_LE(*high, 1.0F);
  EXPECT_GT(*high - *low, 0.05F);
  full.seed = 9;
  EXPECT_NE(water, make_water_density(size, full));
}

TEST(ProceduralCone, FallsWithTheSquaredDistanceOnItsAxisAndEndsAtItsAngle) {
  const ConeShape cone{0.5, 2.5, 20, 30};
  const glm::ivec3 size(33, 33, 20);
  const auto scattering = make_cone_scattering(size, cone);
  const double half = 2.5 * std::tan(glm::radians(30.0));
  for_each_voxel(size, scattering, [&](const glm::ivec3& p, float v) {
    const double z = 0.5 + 2.0 * (p.z + 0.5) / 20;
    const double off = half * std::hypot(2 * (p.x + 0.5) / 33 - 1, 2 * (p.y + 0.5) / 33 - 1);
    if (p.x == 16 && p.y == 16) {
      ASSERT_NEAR(static_cast<double>(v), 1 / (z * z), 1e-6);
    }
    if (off > z * std::tan(glm::radians(30.0))) {
      ASSERT_EQ(v, 0.0F);
    }
    if (off < z * std::tan(glm::radians(20.0))) {
      ASSERT_NEAR(static_cast<double>(v), 1 / (z * z + off * off), 1e-6);
    }
  });
}

TEST(ProceduralRelief, StaysInItsHeightAndReachesDownAtItsSides) {
  ReliefOptions options;
  options.size = {4, 2};
  options.segments = 64;
  options.height_m = 0.08F;
  options.ripples = 0.4F;
  const Mesh mesh = make_relief(options);
  const std::size_t surface = 129 * 65;
  ASSERT_GT(mesh.positions.size(), surface);
  EXPECT_EQ(mesh.triangles.size(), 2U * (128 * 64 + 2 * (128 + 64)));
  float low = 1, high = -1;
  for (std::size_t i = 0; i < surface; ++i) {
    const glm::vec3& p = mesh.positions[i];
    EXPECT_TRUE(std::abs(p.x) <= 2 && std::abs(p.z) <= 1);
    EXPECT_GT(mesh.normals[i].y, 0.2F);
    low = std::min(low, p.y);
    high = std::max(high, p.y);
  }
  EXPECT_GE(low, -0.04F);
  EXPECT_LE(high, 0.04F);
  EXPECT_GT(high - low, 0.04F);
  for (std::size_t i = surface; i < mesh.positions.size(); ++i)
    EXPECT_EQ(mesh.normals[i].y, 0.0F);
  // Triangles face their normals.
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::vec3 face =
        glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
    if (glm::length(face) < 1e-7F) continue;
    ASSERT_GT(glm::dot(glm::normalize(face), mesh.normals[t.x]), 0.0F);
  }
  for (const glm::vec3& n : mesh.normals)
    ASSERT_NEAR(glm::length(n), 1, 1e-5);
}

TEST(ProceduralRelief, WithoutHeightIsFlatAndForASeedTheSame) {
  ReliefOptions options;
  const Mesh one = make_relief(options), again = make_relief(options);
  EXPECT_EQ(one.positions, again.positions);
  options.seed = 3;
  EXPECT_NE(one.positions, make_relief(options).positions);
  options.height_m = 0;
  for (const glm::vec3& p : make_relief(options).positions)
    EXPECT_EQ(p.y, 0.0F);
}

}  // namespace
}  // namespace pellucid
