// Random walks in scattering solids against slabs, furnaces and the walks without scattering.
#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

#include "algorithms/reference/reference.hpp"
#include "algorithms/scattering/slab.hpp"
#include "tests/algorithms/reference/optical_scenes.hpp"

namespace pellucid::test {
namespace {

Material cloudy(float ior, const glm::vec3& scattering, float anisotropy, const glm::vec3& absorption = glm::vec3(0)) {
  Material m = glass(ior, absorption);
  m.scattering = scattering;
  m.anisotropy = anisotropy;
  return m;
}

SurfaceLayer traced(const Scene& scene, const Camera& camera, int samples) {
  SurfaceOptions options;
  options.samples = samples;
  return trace_surfaces(scene, camera, options);
}

glm::dvec3 mean_of(const Image& image) {
  glm::dvec3 sum(0.0);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x)
      sum += pixel(image, x, y);
  }
  return sum / (static_cast<double>(image.width) * image.height);
}

// The frame's mean has the error of a pixel over the root of their number.
double error_of_mean(const SurfaceLayer& layer) {
  return layer.statistics.standard_error_mean / layer.radiance.width;
}

TEST(Translucency, ASlabThatDoesNotBendIsAsTheEquationOfTransferSays) {
  // Seen from straight above, in light from below that is 1, or the cosine to the vertical.
  const glm::vec3 scattering(1.8F, 0.5F, 3.0F), absorption(0.2F, 0.5F, 0.0F);
  for (const bool cosine : {false, true}) {
    Scene scene;
    add(scene, make_box({400.0F, 1.0F, 400.0F}), cloudy(1.0F, scattering, 0.75F, absorption));
    set_environment(scene, glm::vec3(0), glm::vec3(cosine ? 0 : 1), glm::vec3(1));
    // A gradient has one horizon for both halves: light from above is 1 − y there, and the slab reflects it too.
    const Camera camera = looking({0.3F, 30.0F, 0.2F}, {0.3F, 0.0F, 0.2F}, 16, 0.05F, {0, 0, 1});
    const SurfaceLayer layer = traced(scene, camera, 600);
    const glm::dvec3 seen = mean_of(layer.radiance);
    for (int c = 0; c < 3; ++c) {
      const double depth = static_cast<double>(scattering[c] + absorption[c]);
      const scattering::SlabLight light =
          scattering::Slab({0.75, static_cast<double>(scattering[c]) / depth}).light(depth);
      double expected = light.unscattered + light.near_forward;
      for (std::size_t i = 0; i < light.cosine.size(); ++i) {
        const double flux = 2 * kPi * light.weight[i] * light.cosine[i];
        const double below = cosine ? light.cosine[i] : 1, above = cosine ? 0 : 1 - light.cosine[i];
        expected += flux * (light.transmission[i] * below + light.reflection[i] * above);
      }
      // Four standard errors; those of the three channels are not told apart.
      EXPECT_NEAR(seen[c], expected, 4 * error_of_mean(layer) + 1e-3) << c << ' ' << cosine;
    }
    EXPECT_LT(error_of_mean(layer), 0.004);
  }
}

TEST(Translucency, ABallThatAbsorbsNothingVanishesInAFurnace) {
  for (const float anisotropy : {-0.4F, 0.0F, 0.9F}) {
    Scene scene;
    add(scene, make_sphere(1, 48), cloudy(1.4F, {3, 1, 0}, anisotropy));
    set_furnace(scene);
    const SurfaceLayer layer = traced(scene, looking({0, 0.3F, 4}, {0, 0, 0}, 24), 24);
    const glm::dvec3 seen = mean_of(layer.radiance);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(seen[c], 1, 4 * error_of_mean(layer) + 1e-3) << anisotropy << ' ' << c;
    EXPECT_LT(layer.statistics.lost_weight_mean, 1e-6);
  }
}

// A ray that meets an edge of 60° to the last bit: rounding decides which of the faces it meets, and on which side. It
// was refracted between them until too many solids seemed to lie inside one another.
TEST(Translucency, APathEndsWhereItMeetsASharpEdge) {
  Scene scene;
  add(scene, make_cylinder(1, 1.6F, 3), cloudy(1.001F, glm::vec3(1), 0.95F), at({0, -0.8F, 0}));
  set_furnace(scene);
  for (const float distance : {3.1F, 3.2F, 3.3F}) {
    const SurfaceLayer layer = traced(scene, looking({distance, 0, 0}, {0, 0, 0}, 1), 1);
    EXPECT_LT(layer.statistics.rays, 10U) << distance;
  }
}

TEST(Translucency, WithoutScatteringWalksAreTheTree) {
  // A second ball, out of sight, scatters, so that all is walked.
  Scene scene;
  add(scene, make_sphere(1, 48), glass(1.5F, {0.3F, 0.1F, 0.8F}));
  set_environment(scene, {0.2F, 0.4F, 0.9F}, {1.0F, 0.8F, 0.6F}, {0.1F, 0.1F, 0.1F});
  const Camera camera = looking({0, 0.3F, 4}, {0, 0, 0}, 16);
  const glm::dvec3 tree = mean_of(traced(scene, camera, 64).radiance);
  add(scene, make_sphere(0.1F, 16), cloudy(1.2F, glm::vec3(1), 0), at({0, 0, 50}));
  const SurfaceLayer walked = traced(scene, camera, 64);
  const glm::dvec3 walks = mean_of(walked.radiance);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(walks[c], tree[c], 4 * error_of_mean(walked) + 2e-3) << c;
}

TEST(Translucency, TheNoiseIsAsStated) {
  Scene scene;
  add(scene, make_sphere(1, 48), cloudy(1.4F, glm::vec3(2), 0.6F));
  set_environment(scene, {2, 2, 2}, {0.2F, 0.2F, 0.2F}, {0, 0, 0});
  const Camera camera = looking({0, 0.3F, 4}, {0, 0, 0}, 24, 25);
  SurfaceOptions options;
  options.samples = 32;
  const SurfaceLayer a = trace_surfaces(scene, camera, options);
  options.seed = 2;
  const SurfaceLayer b = trace_surfaces(scene, camera, options);
  double apart = 0;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x)
      apart += std::abs(pixel(a.radiance, x, y).y - pixel(b.radiance, x, y).y) / (24.0 * 24.0);
  }
  // The mean of |x − y| of two normal variables is 2σ/√π; strata lessen it.
  const double stated = 2 * a.statistics.standard_error_mean / std::sqrt(kPi);
  EXPECT_LT(apart, 1.15 * stated);
  EXPECT_GT(apart, 0.6 * stated);
}

}  // namespace
}  // namespace pellucid::test
