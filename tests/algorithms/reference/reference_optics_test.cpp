// Pictures of mirrors, metals and dielectrics against closed forms.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "algorithms/reference/pixel_samples.hpp"
#include "algorithms/shaders/optics.hpp"
#include "gl/error.hpp"
#include "tests/algorithms/reference/optical_scenes.hpp"

namespace pellucid {
namespace {

using namespace test;

// Looks straight down at something, from a metre above; +z is up in the picture.
glm::dvec3 seen_from_above(const Scene& scene, const SurfaceOptions& options = {}, float x = 0.0F, float z = 0.0F) {
  return seen(scene, {x, 3.0F, z}, {x, 0.0F, z}, options, {0, 0, 1});
}

// ---- mirrors and metals ----

// A mirror ball in the middle of a round room whose colour is linear in the place.
TEST(ReferenceOptics, MirrorBallInTheMiddleOfARoundRoom) {
  Scene scene;
  scene.ambient = glm::vec3(1.0F);
  Mesh room = make_sphere(5.0F, 256);
  for (const glm::vec3& p : room.positions)
    room.colors.push_back(0.5F + 0.1F * p);
  add(scene, room, matte(glm::vec3(1.0F)));
  add(scene, make_sphere(1.0F, 512), mirror(0.9F));
  const Camera camera = looking({0.4F, 0.3F, 3.5F}, {0.1F, 0, 0}, 24, 50.0F);
  const SurfaceLayer layer = trace_surfaces(scene, camera);
  int on_ball = 0;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) {
      // By hand: |o + t d|² = ρ².
      const auto meet = [](const glm::dvec3& o, const glm::dvec3& d, double radius, bool inside) {
        const double b = glm::dot(o, d), c = glm::dot(o, o) - radius * radius;
        return -b + (inside ? 1.0 : -1.0) * std::sqrt(b * b - c);
      };
      glm::dvec3 o(camera.view.eye), d = camera.ray_direction(x + 0.5, y + 0.5);
      const double t = meet(o, d, 1.0, false);
      const double closest = glm::length(o - glm::dot(o, d) * d);
      if (std::abs(closest - 1.0) < 0.01) continue;  // silhouette of the tessellation
      double share = 1.0;
      if (!std::isnan(t)) {
        o += t * d;
        d = reflected(d, glm::normalize(o));
        share = 0.9;
        ++on_ball;
      }
      const glm::dvec3 wall = o + meet(o, d, 5.0, true) * d;
      const glm::dvec3 expected = share * (0.5 + 0.1 * wall);
      EXPECT_LT(glm::length(pixel(layer.radiance, x, y) - expected), 6e-3) << x << " " << y;
      EXPECT_EQ(*layer.optical.at(x, y), std::isnan(t) ? 0.0F : 1.0F);
    }
  }
  EXPECT_GT(on_ball, 80);
}

TEST(ReferenceOptics, TwoMirrorsMultiplyTheirReflectance) {
  Scene scene;
  set_furnace(scene);
  // Two plates that face each other along x, one metre apart; a ray climbs between them at 45° and gets out.
  const glm::mat4 upright = glm::rotate(glm::mat4(1.0F), glm::half_pi<float>(), {0, 0, 1});
  add(scene, make_plane({10, 10}, 1), mirror(0.8F), at({-0.5F, 0, 0}) * upright);
  add(scene, make_plane({10, 10}, 1), mirror(0.5F), at({0.5F, 0, 0}) * upright);
  // From (0, 0): bounces at heights 0.5, 1.5, 2.5, 3.5, 4.5, beginning at the right; the plates end at 5.
  EXPECT_NEAR(seen(scene, {0, 0, 0}, {1, 1, 0}).x, std::pow(0.5, 3) * std::pow(0.8, 2), 1e-6);
  SurfaceOptions few;
  few.depth = 3;
  const Camera camera = looking({0, 0, 0}, {1, 1, 0}, 1, 1.0F);
  const SurfaceLayer cut = trace_surfaces(scene, camera, few);
  EXPECT_EQ(cut.radiance.pixels[0], 0.0F);
  EXPECT_NEAR(cut.statistics.cut_weight_max, std::pow(0.5, 2) * std::pow(0.8, 2), 1e-6);
  EXPECT_EQ(cut.statistics.rays, 4U);
}

TEST(ReferenceOptics, MetalsReflectByFresnelsTerm) {
  Scene scene;
  set_furnace(scene);
  Material aluminium{.name = "metal", .kind = SurfaceKind::metal};
  aluminium.metal_n = {0.5F, 1.1F, 2.3F};
  aluminium.metal_k = {5.0F, 7.0F, 9.0F};
  aluminium.reflectance = {1.0F, 0.5F, 0.25F};
  add(scene, make_plane({100, 100}, 1), aluminium);
  for (const double degrees : {0.0, 45.0, 85.0}) {
    const double a = glm::radians(degrees);
    const glm::vec3 eye(static_cast<float>(std::sin(a)), static_cast<float>(std::cos(a)), 0.0F);
    const glm::dvec3 radiance = seen(scene, eye, {0, 0, 0}, {}, {0, 0, 1});
    for (int c = 0; c < 3; ++c) {
      const double n = static_cast<double>(aluminium.metal_n[c]), k = static_cast<double>(aluminium.metal_k[c]);
      const double f = ((n - 1) * (n - 1) + k * k + 4 * n * std::pow(1 - std::cos(a), 5)) / ((n + 1) * (n + 1) + k * k);
      EXPECT_NEAR(radiance[c], f * static_cast<double>(aluminium.reflectance[c]), 1e-5);
    }
  }
}

// ---- dielectrics ----

// Head-on, all orders: transmitted (1−F)²T/(1−F²T²), reflected F + F(1−F)²T²/(1−F²T²).
TEST(ReferenceOptics, AbsorbingSlabAtNormalIncidence) {
  const glm::vec3 absorption(0.0F, 0.7F, 3.0F);
  Scene scene;
  set_environment(scene, {0.25F, 0.25F, 0.25F}, glm::vec3(0.0F), {1, 1, 1});
  add(scene, make_box({4.0F, 0.6F, 4.0F}), glass(1.5F, absorption));
  SurfaceOptions options;
  options.cut = 1e-9;
  const double f = 0.04;
  const glm::dvec3 all = seen_from_above(scene, options, 0.21F, 0.13F);
  options.reflections = 0;
  const glm::dvec3 straight = seen_from_above(scene, options, 0.21F, 0.13F);
  options.entry_reflection = false;
  const glm::dvec3 entered = seen_from_above(scene, options, 0.21F, 0.13F);
  for (int c = 0; c < 3; ++c) {
    const double t = std::exp(-static_cast<double>(absorption[c]) * static_cast<double>(0.6F));
    const double orders = 1.0 / (1.0 - f * f * t * t);
    EXPECT_NEAR(all[c], (1 - f) * (1 - f) * t * orders + 0.25 * (f + f * (1 - f) * (1 - f) * t * t * orders), 2e-6);
    EXPECT_NEAR(straight[c], (1 - f) * (1 - f) * t + 0.25 * f, 2e-6);
    EXPECT_NEAR(entered[c], (1 - f) * (1 - f) * t, 2e-6);
  }
}

TEST(ReferenceOptics, OneSidedRefractionIgnoresTheFarSide) {
  Scene scene;
  set_environment(scene, {0, 0, 0}, {0, 0, 0}, {1, 1, 1});  // radiance −y of the direction
  add(scene, make_box({6.0F, 0.6F, 6.0F}), glass(1.5F, glm::vec3(0.7F)));
  SurfaceOptions options;
  options.both_sides = false;
  options.entry_reflection = false;
  const double i = glm::radians(60.0), r = std::asin(std::sin(i) / 1.5);
  const auto x = static_cast<float>(2.0 * std::sin(i)), y = static_cast<float>(2.0 * std::cos(i));
  const glm::dvec3 radiance = seen(scene, {x, 0.3F + y, 0.1F}, {0, 0.3F, 0.1F}, options, {0, 0, 1});
  const double path = static_cast<double>(0.6F) / std::cos(r);
  EXPECT_NEAR(radiance.x,
              (1 - fresnel_of_angles(i, 1 / 1.5)) * std::exp(-static_cast<double>(0.7F) * path) * std::cos(r), 1e-5);
}

TEST(ReferenceOptics, InsideABallOfGlass) {
  Scene scene;
  set_furnace(scene);
  add(scene, make_sphere(2.0F, 256), glass(1.5F, glm::vec3(0.2F)));
  SurfaceOptions options;
  options.cut = 1e-9;
  // Every ray from the centre stays on its line: (1−F) e^{−aR} Σ (F e^{−2aR})^k.
  const double f = 0.04, way = static_cast<double>(0.2F) * 2.0;
  const double expected = (1 - f) * std::exp(-way) / (1 - f * std::exp(-2 * way));
  EXPECT_NEAR(seen(scene, {0, 0, 0}, {1.0F, 0.31F, 0.23F}, options).x, expected, 1e-4);
  EXPECT_NEAR(seen(scene, {0, 0, 0}, {-0.2F, -1.0F, 0.5F}, options).x, expected, 1e-4);
}

TEST(ReferenceOptics, TheNearPlaneMayCutGlassOpen) {
  Scene scene;
  set_environment(scene, glm::vec3(0.0F), glm::vec3(0.0F), glm::vec3(1.0F));
  add(scene, make_box({4.0F, 0.5F, 4.0F}), glass(1.5F, glm::vec3(0.5F)));
  SurfaceOptions options;
  options.reflections = 0;
  Camera camera = looking({0.21F, 0.375F, 0.13F}, {0.21F, 0.0F, 0.13F}, 1, 1.0F, {0, 0, 1});
  camera.view.near_m = 0.25F;  // half-way between the top, at 0.25, and the middle
  const SurfaceLayer layer = trace_surfaces(scene, camera, options);
  EXPECT_NEAR(pixel(layer.radiance, 0, 0).x, 0.96 * std::exp(-0.5 * 0.375), 1e-6);
  EXPECT_EQ(layer.statistics.lost_weight_mean, 0.0);
}

TEST(ReferenceOptics, ABubbleInGlassIsOfTheOuterSolidsIndex) {
  Scene scene;
  set_environment(scene, glm::vec3(0.0F), glm::vec3(0.0F), glm::vec3(1.0F));
  add(scene, make_sphere(1.0F, 256), glass(1.5F, glm::vec3(0.5F)));
  add(scene, make_sphere(0.4F, 256), glass(static_cast<float>(1 / 1.5)));
  SurfaceOptions options;
  options.reflections = 0;
  const double expected = std::pow(0.96, 4) * std::exp(-0.5 * 1.2);
  EXPECT_NEAR(seen_from_above(scene, options, 1e-3F, 1e-3F).x, expected, 2e-4);
  // The eye in the bubble, and in the glass around it.
  const auto below = [&](float y) {
    return seen(scene, {1e-3F, y, 1e-3F}, {1e-3F, y - 1.0F, 1e-3F}, options, {0, 0, 1}).x;
  };
  EXPECT_NEAR(below(0.1F), std::pow(0.96, 2) * std::exp(-0.5 * 0.6), 2e-4);
  EXPECT_NEAR(below(-0.5F), 0.96 * std::exp(-0.5 * 0.5), 2e-4);
  EXPECT_NEAR(below(0.5F), std::pow(0.96, 3) * std::exp(-0.5 * 0.7), 2e-4);
  EXPECT_NEAR(below(-1.5F), 1.0, 1e-6);
}

TEST(ReferenceOptics, GlassCastsAShadowAndHidesNothingElse) {
  Scene scene;
  add(scene, make_plane({20, 20}, 1), matte(glm::vec3(1.0F)));
  add(scene, make_box({1.0F, 0.2F, 1.0F}), glass(1.5F), at({0, 1, 0}));
  scene.lights.push_back(
      {.name = "sun", .direction = {0, -1, 0}, .intensity = glm::vec3(static_cast<float>(kPi)), .casts_shadow = true});
  const auto ground = [&](float x) { return seen(scene, {x, 0.5F, 0.013F}, {x, 0, 0.013F}, {}, {0, 0, 1}).x; };
  EXPECT_NEAR(ground(0.1F), 0.0, 1e-6);
  EXPECT_NEAR(ground(2.0F), 1.0, 1e-6);
}

// ---- conservation ----

TEST(ReferenceOptics, NothingIsLostInAWhiteFurnace) {
  for (const float ior : {1.33F, 1.5F, 2.4F, 0.7F}) {
    const Mesh shapes[] = {make_sphere(1.0F, 64), make_sphere(1.0F, 12), make_box(glm::vec3(1.2F)),
                           make_torus(0.8F, 0.3F, 48), make_cylinder(0.7F, 1.0F, 32)};
    for (const Mesh& shape : shapes) {
      Scene scene;
      set_furnace(scene);
      add(scene, shape, glass(ior), glm::rotate(glm::mat4(1.0F), 0.5F, glm::normalize(glm::vec3(1, 2, 0.3F))));
      SurfaceOptions options;
      options.cut = 1e-3;
      const SurfaceLayer layer = trace_surfaces(scene, looking({0.2F, 0.7F, 4.0F}, {0, 0.1F, 0}, 48), options);
      const SurfaceStatistics& s = layer.statistics;
      double mean = 0.0;
      for (const float v : layer.radiance.pixels) {
        mean += static_cast<double>(v) / static_cast<double>(layer.radiance.pixels.size());
        EXPECT_LE(static_cast<double>(v), 1.0 + 1e-6);
        EXPECT_GE(static_cast<double>(v), 1.0 - s.cut_weight_max - 48 * 48 * s.limited_weight_mean - 1e-6);
      }
      EXPECT_NEAR(mean + s.cut_weight_mean + s.limited_weight_mean, 1.0, 1e-6) << shape.name << " " << ior;
      EXPECT_GT(mean, 0.97) << shape.name << " " << ior;
      EXPECT_EQ(s.lost_weight_mean, 0.0) << shape.name << " " << ior;
    }
  }
}

TEST(ReferenceOptics, AnOpenSolidIsNoticed) {
  Scene scene;
  set_furnace(scene);
  Mesh open = make_sphere(1.0F, 32);
  const std::vector<glm::uvec3> all = open.triangles;
  open.triangles.resize(open.triangles.size() / 2);
  add(scene, open, glass(1.5F));
  EXPECT_GT(trace_surfaces(scene, looking({0, 2, 3}, {0, 0, 0}, 32)).statistics.lost_weight_mean, 3e-3);
  scene.meshes[0].triangles = all;
  for (glm::uvec3& triangle : scene.meshes[0].triangles)
    std::swap(triangle.y, triangle.z);
  EXPECT_GT(trace_surfaces(scene, looking({0, 2, 3}, {0, 0, 0}, 32)).statistics.lost_weight_mean, 0.05) << "inside out";
}

// The same picture at all scales, near the origin and away from it: rays do not meet what they leave.
TEST(ReferenceOptics, ScaleDoesNotMatter) {
  const auto picture = [](float scale, const glm::vec3& shift) {
    Scene scene;
    set_environment(scene, {0.2F, 0.4F, 0.9F}, {0.9F, 0.7F, 0.5F}, {0.1F, 0.3F, 0.1F});
    const glm::mat4 placed = glm::scale(at(shift), glm::vec3(scale));
    add(scene, make_sphere(1.0F, 64), glass(1.5F), placed);
    add(scene, make_box(glm::vec3(0.5F)), mirror(), placed * at({1.4F, 0.1F, 0.5F}));
    Camera camera = looking(shift + scale * glm::vec3(0.4F, 1.2F, 4.0F), shift, 24);
    const SurfaceLayer layer = trace_surfaces(scene, camera);
    EXPECT_EQ(layer.statistics.lost_weight_mean, 0.0) << scale;
    return layer.radiance;
  };
  const Image unit = picture(1.0F, glm::vec3(0.0F));
  const auto compare = [&](const Image& other, double tolerance) {
    int off = 0;
    for (std::size_t i = 0; i < unit.pixels.size(); ++i)
      off += std::abs(static_cast<double>(unit.pixels[i]) - static_cast<double>(other.pixels[i])) > tolerance ? 1 : 0;
    return off;
  };
  EXPECT_EQ(compare(picture(1e-4F, glm::vec3(0.0F)), 1e-3), 0);
  EXPECT_EQ(compare(picture(1e5F, glm::vec3(0.0F)), 1e-3), 0);
  // A unit ball 300 m away: coordinates are rounded to 2e-5, and a ray near an edge may take its other side.
  EXPECT_LT(compare(picture(1.0F, {300.0F, 200.0F, -100.0F}), 5e-3), 20);
}

// ---- pixels ----

TEST(ReferenceSamples, CellsAreOfEqualArea) {
  for (const int n : {2, 3, 5, 7, 12, 16, 64}) {
    const PixelSamples samples(n, 1);
    constexpr int kPixels = 4000;
    glm::dvec2 mean(0.0);
    int corner = 0;
    for (int x = 0; x < kPixels; ++x) {
      for (int s = 0; s < n; ++s) {
        const glm::dvec2 place = samples.at(x, 3, s);
        ASSERT_TRUE(place.x >= 0.0 && place.x < 1.0 && place.y >= 0.0 && place.y < 1.0);
        mean += place / static_cast<double>(n * kPixels);
        corner += place.x < 0.3 && place.y < 0.4 ? 1 : 0;
      }
    }
    const double sigma = 0.5 / std::sqrt(n * kPixels);
    EXPECT_NEAR(mean.x, 0.5, 4 * sigma) << n;
    EXPECT_NEAR(mean.y, 0.5, 4 * sigma) << n;
    EXPECT_NEAR(static_cast<double>(corner) / (n * kPixels), 0.12, 4 * sigma) << n;
  }
  EXPECT_EQ(PixelSamples(1, 9).at(4, 5, 0), glm::dvec2(0.5));
}

TEST(ReferenceSamples, ConvergeToTheCoverageWithinTheirStandardError) {
  Scene scene;
  const Mesh half = make_plane({2, 2}, 1);
  add(scene, half, matte(glm::vec3(0.0F), glm::vec3(1.0F)), at({1.0F, 0, 0}));  // covers x > 0
  Camera camera = looking({0.137F, 1.0F, 0.0F}, {0.137F, 0, 0}, 1, 45.0F, {0, 0, -1});
  const double half_width = std::tan(glm::radians(22.5));
  const double expected = 0.5 * (1.0 + static_cast<double>(0.137F) / half_width);
  double spread = 0.0, stated = 0.0;
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    SurfaceOptions options;
    options.samples = 64;
    options.seed = seed;
    const SurfaceLayer layer = trace_surfaces(scene, camera, options);
    const double error = static_cast<double>(layer.radiance.pixels[0]) - expected;
    EXPECT_LT(std::abs(error), 4.0 * layer.statistics.standard_error_max);
    spread += error * error / 40.0;
    stated = layer.statistics.standard_error_max;
    EXPECT_EQ(layer.statistics.standard_error_mean, layer.statistics.standard_error_max);
  }
  EXPECT_LT(std::sqrt(spread), 0.6 * stated) << "strata help, and the error stated is an upper bound";
  EXPECT_EQ(trace_surfaces(scene, camera).statistics.standard_error_max, 0.0);
}

TEST(ReferenceOptics, DoesNotDependOnThreads) {
  Scene scene;
  set_environment(scene, {0.2F, 0.4F, 0.9F}, {0.9F, 0.7F, 0.5F}, {0.1F, 0.3F, 0.1F});
  add(scene, make_teapot(0.6F, 4), glass(1.5F));
  SurfaceOptions options;
  options.samples = 3;
  const Camera camera = looking({0, 1, 3}, {0, 0.3F, 0}, 40);
  const SurfaceLayer many = trace_surfaces(scene, camera, options);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const SurfaceLayer single = trace_surfaces(scene, camera, options);
  EXPECT_EQ(many.radiance.pixels, single.radiance.pixels);
  EXPECT_EQ(many.statistics.rays, single.statistics.rays);
}

// ---- what is refused ----

TEST(ReferenceOptics, RefusesAMediumBehindGlassAndSamplesOfAMedium) {
  Scene scene;
  scene.name = "tank";
  scene.volume.emplace();
  scene.volume->density = {1.0F};
  const Camera camera = looking({0, 0, 3}, {0, 0, 0}, 2);
  SurfaceOptions options;
  options.samples = 4;
  EXPECT_THROW(trace_surfaces(scene, camera, options), InputError);
  EXPECT_NO_THROW(trace_surfaces(scene, camera));
  add(scene, make_sphere(1.0F, 8), glass(1.5F));
  try {
    trace_surfaces(scene, camera);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(),
                 "scene 'tank' has a volume, and mirrors, metals or dielectrics: the reference does not trace a medium "
                 "behind them");
  }
  scene.volume.reset();
  EXPECT_TRUE(has_interfaces(scene));
  EXPECT_THROW(
      shade_surfaces(scene, camera, {Image(2, 2, 3), Image(2, 2, 3), Image(2, 2, 3), std::vector<double>(4, 1.0)}),
      InputError);
}

TEST(ReferenceOptics, ThePictureCarriesMaskAndStatistics) {
  Scene scene;
  set_furnace(scene);
  add(scene, make_sphere(1.0F, 32), glass(1.5F));
  const Camera camera = looking({0, 0, 4}, {0, 0, 0}, 16);
  SurfaceOptions options;
  options.samples = 4;
  const Reference reference = render_reference(scene, camera, trace_surfaces(scene, camera, options));
  EXPECT_EQ(*reference.mask.at(8, 8), 1.0F);
  EXPECT_EQ(*reference.mask.at(0, 0), 0.0F);
  EXPECT_EQ(reference.surfaces.samples, 4);
  EXPECT_GT(reference.surfaces.rays, 16U * 16U * 4U);
  EXPECT_EQ(reference.image.at(8, 8)[3], 1.0F);
}

}  // namespace
}  // namespace pellucid
