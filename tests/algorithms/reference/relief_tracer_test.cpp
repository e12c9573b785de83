// The optics of a relief on flat layers, whose answers are known.
#include "algorithms/reference/relief/relief_tracer.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

#include <gtest/gtest.h>

#include "algorithms/shaders/optics.hpp"
#include "tests/algorithms/relief_scenes.hpp"

namespace pellucid {
namespace {

using namespace test;

constexpr double kTop = -0.05, kFloor = -0.25, kIndex = 1.33;

Relief flat_relief() {
  Relief relief;
  relief.cut = false;
  relief.solid = flat_layer(static_cast<float>(kFloor), -0.5F);
  relief.solid.albedo = {0.8F, 0.5F, 0.3F};
  relief.translucent = flat_layer(static_cast<float>(kTop), -0.5F);
  relief.index = static_cast<float>(kIndex);
  relief.absorption = {1.0F, 2.0F, 5.0F};
  return relief;
}

ReliefPlace place_at_origin() {
  ReliefPlace place;
  place.frame = {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}, 2.0, 2.0};
  place.uv = {0.5, 0.5};
  return place;
}

bool everything(std::size_t, const glm::dvec3&, const glm::dvec3&, double) {
  return true;
}

glm::dvec3 rgb(const glm::vec3& v) {
  return glm::dvec3(v);
}

// Snell, Fresnel at both crossings, absorption over both ways.
TEST(ReliefTracer, FlatLayerInClosedForm) {
  const Scene scene = relief_scene(flat_relief());
  const Illumination light(scene);
  const ReliefTracer tracer(scene, 0, light);
  const Relief& relief = scene.reliefs[0];
  for (const double angle_deg : {0.0, 20.0, 50.0, 80.0}) {
    const double a = glm::radians(angle_deg);
    const glm::dvec3 v(std::sin(a), 0.0, -std::cos(a));
    const auto hit = tracer.first_hit(place_at_origin(), v);
    ASSERT_TRUE(hit && hit->medium);
    EXPECT_NEAR(hit->distance_m, -kTop / std::cos(a), 1e-7);

    const double depth = kTop - kFloor, inner = std::asin(std::sin(a) / kIndex);
    const double reflected_share = fresnel_dielectric(std::cos(a), 1 / kIndex);
    const double light_cosine = 0.8;  // straight inside, as in the paper
    const double entering = 1 - fresnel_dielectric(light_cosine, 1 / kIndex);
    for (int c = 0; c < 3; ++c) {
      const double absorption = static_cast<double>(relief.absorption[c]);
      const double floor_light = entering * std::exp(-absorption * depth / light_cosine) *
                                 rgb(scene.lights[0].intensity)[c] * light_cosine / std::numbers::pi;
      const double floor = rgb(relief.solid.albedo)[c] * (rgb(scene.ambient)[c] + floor_light);
      const double expected = (1 - reflected_share) * std::exp(-absorption * depth / std::cos(inner)) * floor +
                              reflected_share * rgb(scene.environment.zenith)[c];
      const double found = tracer.radiance(place_at_origin(), v, *hit, everything)[c];
      EXPECT_NEAR(found, expected, 1e-6) << angle_deg << "°, channel " << c;
    }
  }
}

// With its rays bent the light is steeper inside, its way shorter, and the power through a level surface kept.
TEST(ReliefTracer, BentLightKeepsItsPower) {
  const Scene scene = relief_scene(flat_relief());
  const Illumination light(scene);
  const ReliefTracer tracer(scene, 0, light, {.refract_light = true});
  const double sine = 0.6 / kIndex, inner_cosine = std::sqrt(1 - sine * sine);
  const glm::dvec3 share = tracer.light_reaching(place_at_origin(), {0, 0, kFloor}, {0.6, 0.0, 0.8}, -1.0);
  const double entering = 1 - fresnel_dielectric(0.8, 1 / kIndex);
  for (int c = 0; c < 3; ++c) {
    const double absorption = static_cast<double>(scene.reliefs[0].absorption[c]);
    // Times the inner cosine on a level floor: entering · 0.8 · what absorption leaves.
    EXPECT_NEAR(share[c] * inner_cosine, entering * 0.8 * std::exp(-absorption * (kTop - kFloor) / inner_cosine), 1e-6);
  }
}

// Total reflection where the eye is in the denser medium: nothing of the solid is seen.
TEST(ReliefTracer, TotalReflectionFromTheDenserSide) {
  Relief relief = flat_relief();
  relief.outside_index = 1.5F;
  relief.index = 1.0F;
  const Scene scene = relief_scene(relief);
  const Illumination light(scene);
  const ReliefTracer tracer(scene, 0, light);
  const double a = glm::radians(60.0);  // the critical angle is 41.8°
  const glm::dvec3 v(std::sin(a), 0.0, -std::cos(a));
  const auto hit = tracer.first_hit(place_at_origin(), v);
  ASSERT_TRUE(hit && hit->medium);
  const glm::dvec3 seen = tracer.radiance(place_at_origin(), v, *hit, everything);
  EXPECT_NEAR(glm::distance(seen, rgb(scene.environment.zenith)), 0.0, 1e-6);
}

TEST(ReliefTracer, OcclusionOfBareSolidAndOfAWall) {
  Relief relief;
  relief.cut = false;
  Image wall(32, 1, 1);  // a ridge from u = 1/2 on
  for (int x = 0; x < 32; ++x)
    *wall.at(x, 0) = x >= 16 && x < 20 ? 1.0F : 0.0F;
  relief.solid = layer_of(wall, -0.3F, 0.0F);
  const Scene scene = relief_scene(relief);
  const Illumination light(scene);
  const ReliefTracer tracer(scene, 0, light);
  const ReliefPlace place = place_at_origin();  // 2 m over u: the ridge spans x from 0 to 0.25
  const glm::dvec3 to_light(0.6, 0.0, 0.8);
  EXPECT_EQ(tracer.light_reaching(place, {-0.05, 0, -0.3}, to_light, 1.0), glm::dvec3(0.0)) << "in the ridge's shadow";
  EXPECT_EQ(tracer.light_reaching(place, {-0.6, 0, -0.3}, to_light, 1.0), glm::dvec3(1.0)) << "in the open";
  EXPECT_EQ(tracer.light_reaching(place, {0.5, 0, -0.3}, {0.6, 0.0, -0.8}, 1.0), glm::dvec3(0.0)) << "from below";
}

// A medium wholly below the solid is not there.
TEST(ReliefTracer, BuriedMediumIsNotSeen) {
  Relief relief = flat_relief();
  relief.translucent = flat_layer(-0.4F, -0.5F);
  Relief bare = relief;
  bare.translucent.reset();
  const Scene with = relief_scene(relief), without = relief_scene(bare);
  const Illumination light(with);
  const glm::dvec3 v = glm::normalize(glm::dvec3(0.3, 0.2, -1.0));
  const ReliefTracer a(with, 0, light), b(without, 0, light);
  const auto hit = a.first_hit(place_at_origin(), v);
  ASSERT_TRUE(hit);
  EXPECT_FALSE(hit->medium);
  EXPECT_EQ(a.radiance(place_at_origin(), v, *hit, everything),
            b.radiance(place_at_origin(), v, *b.first_hit(place_at_origin(), v), everything));
}

glm::dvec3 mean_radiance(const Scene& scene, const glm::dvec3& v, int walks) {
  const Illumination light(scene);
  const ReliefTracer tracer(scene, 0, light);
  const auto hit = tracer.first_hit(place_at_origin(), v);
  Random random(3);
  glm::dvec3 sum(0.0);
  for (int i = 0; i < walks; ++i)
    sum += tracer.radiance(place_at_origin(), v, *hit, everything, {}, &random);
  return sum / static_cast<double>(walks);
}

// A medium that scatters as good as nothing is one that absorbs.
TEST(ReliefTracer, WalksWithoutScatteringAreRays) {
  Relief relief = flat_relief();
  const Scene clear = relief_scene(relief);
  relief.scattering = glm::vec3(1e-6F);
  const glm::dvec3 v = glm::normalize(glm::dvec3(0.3, 0.2, -1.0));
  const glm::dvec3 expected = mean_radiance(clear, v, 1), found = mean_radiance(relief_scene(relief), v, 4000);
  // Distances are drawn where absorption could have ended them, so that walks weigh differently: 4000 of them.
  EXPECT_LT(glm::distance(found, expected), 0.01 * glm::length(expected));
}

// In light that is the same everywhere a white solid under a medium that takes nothing is as bright as its
// surroundings.
TEST(ReliefTracer, WhiteFurnaceWithAScatteringMedium) {
  Relief relief = flat_relief();
  relief.solid.albedo = glm::vec3(1.0F);
  relief.absorption = glm::vec3(0.0F);
  relief.scattering = {2.0F, 10.0F, 40.0F};
  relief.anisotropy = 0.5F;
  Scene scene = relief_scene(relief);
  scene.lights.clear();
  scene.ambient = glm::vec3(1.0F);
  scene.environment.zenith = scene.environment.horizon = scene.environment.ground = glm::vec3(1.0F);
  const glm::dvec3 found = mean_radiance(scene, glm::normalize(glm::dvec3(0.3, 0.2, -1.0)), 4000);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(found[c], 1.0, 0.03);  // the channels' weights vary about 1
}

// A thin albedo over a black solid: single scattering in closed form, and second orders a hundredth of it.
TEST(ReliefTracer, ScattersOnceInClosedForm) {
  Relief relief = flat_relief();
  relief.index = 1.0F;
  relief.solid.albedo = glm::vec3(0.0F);
  relief.absorption = glm::vec3(9.9F);
  relief.scattering = glm::vec3(0.1F);
  relief.anisotropy = 0.4F;
  Scene scene = relief_scene(relief);
  scene.ambient = glm::vec3(0.0F);
  scene.environment.zenith = scene.environment.horizon = scene.environment.ground = glm::vec3(0.0F);
  const glm::dvec3 v = glm::normalize(glm::dvec3(0.3, 0.2, -1.0)), found = mean_radiance(scene, v, 100'000);
  const double mu = -v.z, mu_light = 0.8, cosine = glm::dot(v, glm::dvec3(0.6, 0.0, 0.8)), g = 0.4;
  const double base = 1 + g * g - 2 * g * cosine, both = 1 / mu + 1 / mu_light;
  const double phase = (1 - g * g) / (4 * std::numbers::pi * base * std::sqrt(base));
  for (int c = 0; c < 3; ++c) {
    const double expected =
        0.01 * phase * rgb(scene.lights[0].intensity)[c] / mu * (1 - std::exp(-10.0 * (kTop - kFloor) * both)) / both;
    EXPECT_NEAR(found[c], expected, 0.02 * expected) << c;
  }
}

}  // namespace
}  // namespace pellucid
