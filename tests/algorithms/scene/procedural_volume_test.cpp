#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/scene/noise.hpp"
#include "algorithms/scene/shapes/procedural.hpp"

namespace pellucid {
namespace {

TEST(ProceduralNoise, HashesAreThoseOfEveryPlatform) {
  std::uint32_t all = 0;
  for (std::int32_t x = -3; x < 3; ++x) {
    for (std::int32_t y = -3; y < 3; ++y) {
      for (std::int32_t z = -3; z < 3; ++z)
        all = hash_bits(all ^ hash_bits(x, y, z, 42));
    }
  }
  EXPECT_EQ(all, 1203097038U);
  EXPECT_EQ(hash_bits(0U), 0U);  // the mixer's only known fixed point
  EXPECT_EQ(unit_float(0U), 0.0F);
  EXPECT_EQ(unit_float(~0U), 1.0F - 0x1p-24F);
}

TEST(ProceduralNoise, ValuesAreRecorded) {
  EXPECT_NEAR(gradient_noise({0.3F, 1.7F, -2.4F}, 7), -0.708952188F, 1e-6F);
  EXPECT_NEAR(value_noise({0.3F, 1.7F, -2.4F}, 7), 0.756715953F, 1e-6F);
  EXPECT_NEAR(fractal_noise({0.3F, 1.7F, -2.4F}, 5, 7), -0.371288389F, 1e-6F);
}

TEST(ProceduralNoise, RandomStreamsAreUniformAndApart) {
  Random a(5, 1), again(5, 1), b(5, 2);
  double sum = 0, product = 0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const float u = a.next();
    ASSERT_EQ(u, again.next());
    ASSERT_TRUE(u >= 0.0F && u < 1.0F);
    sum += static_cast<double>(u);
    product += (static_cast<double>(u) - 0.5) * (static_cast<double>(b.next()) - 0.5);
  }
  EXPECT_NEAR(sum / n, 0.5, 0.01);
  EXPECT_NEAR(product / n, 0.0, 0.003);
  for (int i = 0; i < 1000; ++i) {
    const int k = a.below(7);
    ASSERT_TRUE(k >= 0 && k < 7);
  }
}

TEST(ProceduralNoise, GradientNoiseIsZeroOnTheLatticeBoundedAndSmooth) {
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const glm::vec3 p{random.range(-20, 20), random.range(-20, 20), random.range(-20, 20)};
    EXPECT_EQ(gradient_noise(glm::floor(p), 9), 0.0F);
    const float v = gradient_noise(p, 9);
    EXPECT_LE(std::abs(v), 1.0F);
    EXPECT_NEAR(gradient_noise(p + glm::vec3(1e-3F), 9), v, 0.02F);
    // Across a lattice plane, too.
    const glm::vec3 q(std::round(p.x), p.y, p.z);
    EXPECT_NEAR(gradient_noise(q - glm::vec3(1e-4F, 0, 0), 9), gradient_noise(q + glm::vec3(1e-4F, 0, 0), 9), 2e-3F);
  }
}

TEST(ProceduralNoise, ARowEqualsItsPoints) {
  std::vector<float> row(100, 0.25F);
  add_gradient_noise_row(-2.3F, 0.0713F, 1.37F, -4.2F, 17, 0.5F, row);
  for (std::size_t i = 0; i < row.size(); ++i) {
    const float x = -2.3F + static_cast<float>(i) * 0.0713F;
    EXPECT_NEAR(row[i], 0.25F + 0.5F * gradient_noise({x, 1.37F, -4.2F}, 17), 1e-6F);
  }
}

double total(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(ProceduralFog, FallsWithHeightAndStaysInRange) {
  const glm::ivec3 size(24, 32, 20);
  FogOptions even;
  even.contrast = 0.0F;
  even.height_falloff = 2.5F;
  const auto layer = make_fog_density(size, even);
  ASSERT_EQ(layer.size(), 24U * 32U * 20U);
  for (int y = 0; y < size.y; ++y) {
    const float expected = std::exp(-2.5F * (static_cast<float>(y) + 0.5F) / 32.0F);
    EXPECT_NEAR(layer[static_cast<std::size_t>(y * 24 + 5)], expected, 1e-6F);
  }
  const auto patchy = make_fog_density(size, FogOptions{});
  const auto [low, high] = std::minmax_element(patchy.begin(), patchy.end());
  EXPECT_GE(*low, 0.0F);
  EXPECT_LE(*high, 1.0F);
  EXPECT_NEAR(total(patchy), 3161.8766, 0.05);
  EXPECT_EQ(patchy, make_fog_density(size, FogOptions{}));
  FogOptions other;
  other.seed = 2;
  EXPECT_NE(patchy, make_fog_density(size, other));
}

TEST(ProceduralFog, ContrastOneReachesZero) {
  FogOptions options;
  options.contrast = 1.0F;
  options.height_falloff = 0.0F;
  const auto density = make_fog_density(glm::ivec3(48), options);
  const auto [low, high] = std::minmax_element(density.begin(), density.end());
  EXPECT_LT(*low, 0.02F);
  EXPECT_GT(*high, 0.9F);
}

TEST(ProceduralBall, FillsItsShareOfTheBox) {
  for (const glm::ivec3 size : {glm::ivec3(32), glm::ivec3(40, 24, 16), glm::ivec3(1), glm::ivec3(2)}) {
    const auto ball = make_ball_density(size);
    const double voxels = static_cast<double>(size.x) * size.y * size.z;
    EXPECT_NEAR(total(ball) / voxels, std::numbers::pi / 6.0, size.x > 2 ? 3e-4 : 5e-3);
    for (const float v : ball)
      ASSERT_TRUE(v >= 0.0F && v <= 1.0F);
    for (std::size_t i = 0; i < ball.size(); ++i)
      ASSERT_NEAR(ball[i], ball[ball.size() - 1 - i], 1e-6F);
  }
}

TEST(ProceduralBall, IsUniformInsideAndCoversTheBorderByShares) {
  const int n = 32;
  const auto ball = make_ball_density(glm::ivec3(n));
  int partly = 0;
  for (int z = 0; z < n; ++z) {
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        const glm::dvec3 p = (glm::dvec3(x, y, z) + 0.5) / (0.5 * n) - 1.0;
        const double r = glm::length(p), half_diagonal = std::sqrt(3.0) / n;
        const float v = ball[static_cast<std::size_t>((z * n + y) * n + x)];
        if (r < 1.0 - half_diagonal) {
          ASSERT_EQ(v, 1.0F);
        } else if (r > 1.0 + half_diagonal) {
          ASSERT_EQ(v, 0.0F);
        } else {
          partly += v > 0.0F && v < 1.0F ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(partly, 2000);
}

TEST(ProceduralConstant, IsConstant) {
  EXPECT_EQ(make_constant_density({2, 3, 4}, 0.7F), std::vector<float>(24, 0.7F));
}

}  // namespace
}  // namespace pellucid
