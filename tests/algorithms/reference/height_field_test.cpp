// Exact rays against height fields.
#include "algorithms/reference/relief/height_field.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "tests/algorithms/relief_scenes.hpp"

namespace pellucid {
namespace {

using namespace test;

double over(const HeightField& field, const ReliefRay& ray, double t) {
  return ray.at(t).z - field.height_m(ray.uv_at(t));
}

// A wave along u alone is a polygon of chords between texel centres: where a vertical and a slanted ray meet it is
// known.
TEST(HeightField, MeetsAPlaneWaveWhereItsChordsAre) {
  constexpr int kTexels = 64;
  Image heights(kTexels, 1, 1);
  for (int x = 0; x < kTexels; ++x)
    *heights.at(x, 0) = static_cast<float>(0.5 + 0.5 * std::cos(2 * std::numbers::pi * (x + 0.5) / kTexels));
  const ReliefLayer layer = layer_of(heights, -0.2F, 0.0F);
  const HeightField field(layer, glm::dvec2(1.0));
  for (const double u : {0.1, 0.37, 0.5, 0.999, 2.3}) {
    const double at = u * kTexels - 0.5, low = std::floor(at), f = at - low;
    const auto texel = [&](double i) {
      const int wrapped = static_cast<int>(i + 10 * kTexels) % kTexels;
      return -0.2 + 0.2 * static_cast<double>(*heights.at(wrapped, 0));
    };
    const double expected = (1 - f) * texel(low) + f * texel(low + 1);
    const ReliefRay down{{0, 0, 0}, {0, 0, -1}, {u, 0.3}, {1, 1}};
    const auto hit = field.crossing(down, 0.0, 1.0, 1.0);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(-*hit, expected, 1e-8);
    // The chord's line against the ray's: z = −t/√2 along u at 45°.
    const ReliefRay slant{{0, 0, 0}, glm::normalize(glm::dvec3(1, 0, -1)), {u, 0.3}, {1, 1}};
    const auto met = field.crossing(slant, 0.0, 1.0, 1.0);
    ASSERT_TRUE(met);
    EXPECT_NEAR(over(field, slant, *met), 0.0, 1e-8);
  }
}

TEST(HeightField, AgreesWithTinyStepsOnRandomFields) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const ReliefLayer layer = layer_of(random_field(16, 3), -0.3F, 0.0F);
  const HeightField field(layer, {2.0, 1.0});
  int hits = 0, misses = 0;
  for (int i = 0; i < 2000; ++i) {
    const double side = i % 3 == 0 ? -1.0 : 1.0;
    ReliefRay ray{
        {0, 0, side > 0 ? 0.0 : -0.31},
        glm::normalize(glm::dvec3{unit(random) - 0.5, unit(random) - 0.5, -side * (0.05 + 0.5 * unit(random))}),
        {unit(random), unit(random)},
        {0.7, 1.3}};
    const double end = 0.1 + unit(random);
    constexpr int kSteps = 4000;
    double expected = -1;
    for (int step = 1; step <= kSteps && expected < 0; ++step) {
      const double t = end * step / kSteps;
      if (side * over(field, ray, t) < 0) expected = t;
    }
    const auto found = field.crossing(ray, 0.0, end, side);
    if (expected < 0) {
      // Tiny steps may pass through what is thinner still.
      if (found) {
        EXPECT_NEAR(over(field, ray, *found), 0.0, 1e-9);
      }
      misses += found ? 0 : 1;
      continue;
    }
    ++hits;
    ASSERT_TRUE(found) << i;
    EXPECT_LE(*found, expected + 1e-9) << i;
    EXPECT_NEAR(over(field, ray, *found), 0.0, 1e-9) << i;
  }
  EXPECT_GT(hits, 800);
  EXPECT_GT(misses, 100);
}

// A ray that leaves the surface it starts on does not meet it there; one that goes into it does at once.
TEST(HeightField, StartsOnTheSurface) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const ReliefLayer layer = layer_of(random_field(16, 3), -0.3F, 0.0F);
  const HeightField field(layer, {1.0, 1.0});
  for (int i = 0; i < 2000; ++i) {
    ReliefRay ray{{0, 0, 0}, {0, 0, 1}, {unit(random), unit(random)}, {1, 1}};
    ray.origin.z = field.height_m(ray.uv);
    const auto up = field.crossing(ray, 0.0, 1.0, 1.0);
    EXPECT_FALSE(up) << i;
    ray.direction.z = -1;
    const auto down = field.crossing(ray, 0.0, 1.0, 1.0);
    ASSERT_TRUE(down) << i;
    EXPECT_NEAR(*down, 0.0, 1e-9);
  }
}

TEST(HeightField, ClipsToTheSlabAndTheTexture) {
  const ReliefRay ray{{0, 0, 0}, glm::normalize(glm::dvec3(1, 0, -1)), {0.75, 0.5}, {1, 1}};
  const auto repeated = clip(ray, -0.5, -0.1, false, 0.0);
  ASSERT_TRUE(repeated);
  EXPECT_NEAR(repeated->x, 0.1 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(repeated->y, 0.5 * std::sqrt(2.0), 1e-12);
  const auto cut = clip(ray, -0.5, -0.1, true, 0.0);
  ASSERT_TRUE(cut);
  EXPECT_NEAR(cut->y, 0.25 * std::sqrt(2.0), 1e-12);
  EXPECT_FALSE(clip(ray, -0.5, -0.3, true, 0.0)) << "it leaves the texture before it comes so deep";
}

}  // namespace
}  // namespace pellucid
