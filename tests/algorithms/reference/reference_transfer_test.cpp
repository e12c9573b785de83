#include <cmath>

#include <gtest/gtest.h>

#include "algorithms/reference/media/cubic.hpp"
#include "algorithms/reference/media/medium_path.hpp"
#include "algorithms/reference/reference.hpp"
#include "algorithms/scene/noise.hpp"
#include "tests/algorithms/reference/reference_scenes.hpp"

namespace pellucid {
namespace {

using namespace test;

// ---- cubics and the transfer function's kinks ----

TEST(ReferenceCubic, PartsAreMonotoneAndRootsExact) {
  Random random(5);
  for (int i = 0; i < 3000; ++i) {
    const double flat = i % 3 == 0 ? 0.0 : 1.0;  // a parabola, too
    const Cubic c{random.range(-1, 1), random.range(-4, 4), random.range(-8, 8), flat * widened(random.range(-6, 6))};
    double ends[4];
    const int count = monotone_parts(c, ends);
    ASSERT_GE(count, 2);
    for (int k = 0; k + 1 < count; ++k) {
      ASSERT_LT(ends[k], ends[k + 1]);
      const double a = value(c, ends[k]), b = value(c, ends[k + 1]);
      double before = a;
      for (int j = 1; j <= 32; ++j) {
        const double v = value(c, glm::mix(ends[k], ends[k + 1], j / 32.0));
        ASSERT_TRUE(b > a ? v >= before - 1e-12 : v <= before + 1e-12);
        before = v;
      }
      const double wanted = glm::mix(a, b, widened(random.next()));
      const double s = solve_monotone(c, wanted, ends[k], ends[k + 1]);
      ASSERT_NEAR(value(c, s), wanted, 1e-14);
    }
    const Cubic part = stretched(c, 0.3, 0.8);
    ASSERT_NEAR(value(part, 0.25), value(c, 0.3 + 0.5 * 0.25), 1e-14);
  }
}

TEST(ReferenceTransfer, OpticalDepthCrossesKinksExactly) {
  const Volume volume = kinked_volume();
  const MediumGrid grid(volume);
  Random random(6);
  for (int i = 0; i < 10; ++i) {
    const auto inside = [&] { return glm::dvec3(random.range(-2, 6), random.range(-1, 3), random.range(-2, 2)); };
    const glm::dvec3 a = inside(), b = inside(), d = glm::normalize(b - a);
    const int steps = 100000;
    double marched = 0;
    for (int k = 0; k < steps; ++k)
      marched += mapped(volume, density_at(volume, glm::mix(a, b, (k + 0.5) / steps))).extinction;
    marched *= glm::distance(a, b) / steps;
    EXPECT_NEAR(grid.optical_depth(a, d, grid.clip(a, d, {0.0, glm::distance(a, b)})), marched, 1e-7);
  }
}

TEST(ReferenceTransfer, AConstantOneIsBeerLambertWhateverTheDensity) {
  Scene scene;
  scene.volume = kinked_volume();
  scene.volume->transfer = {{0.3F, 0.25F, {0.5F, 1, 1}}, {0.6F, 0.25F, {0.5F, 1, 1}}};
  scene.ambient = {1, 2, 0};
  const Reference result = seen_along_x(scene);
  const double transmittance = std::exp(-1.5 * 0.25 * 8.0);
  expect_near(result, glm::dvec3(scene.volume->albedo) * glm::dvec3(0.5, 2, 0) * (1.0 - transmittance));
  EXPECT_NEAR(widened(result.image.at(0, 0)[3]), transmittance, 1e-8);
}

TEST(ReferenceTransfer, ALinearOneIsNone) {
  Scene scene;
  scene.volume = kinked_volume();
  scene.volume->transfer.clear();
  scene.ambient = {1, 1, 1};
  scene.lights = {{.name = "lamp", .kind = LightKind::point, .position = {1, 1, 0.5F}, .intensity = {3, 2, 1}}};
  const glm::dvec3 plain = radiance(seen_along_x(scene));
  scene.volume->transfer = {{0, 0, glm::vec3(1)}, {0.3F, 0.3F, glm::vec3(1)}, {2, 2, glm::vec3(1)}};
  expect_near(seen_along_x(scene), plain);
}

TEST(ReferenceTransfer, ColoursFollowTheDensity) {
  Scene scene;
  scene.volume = kinked_volume();
  scene.ambient = {0.5F, 1, 2};
  scene.volume->emission = {0, 0.25F, 0};
  // Midpoint marching: C changes with the density under ambient light alone.
  glm::dvec3 expected(0.0);
  double depth = 0;
  const int steps = 400000;
  const double dt = 8.0 / steps;
  for (int i = 0; i < steps; ++i) {
    const Mapped at = mapped(*scene.volume, density_at(*scene.volume, on_axis((i + 0.5) * dt)));
    const glm::dvec3 source = glm::dvec3(0, 0.25, 0) + at.albedo * glm::dvec3(scene.ambient);
    expected += source * (at.extinction * std::exp(-depth - 0.5 * at.extinction * dt) * dt);
    depth += at.extinction * dt;
  }
  const Reference result = seen_along_x(scene);
  expect_near(result, expected);
  EXPECT_LT(result.step_error_max, 1e-6);
}

}  // namespace
}  // namespace pellucid
