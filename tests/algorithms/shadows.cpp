// Variance shadow maps and anti-aliased occlusion rates.
#include "algorithms/shaders/shadows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/raster/shadow_maps.hpp"
#include "gl/program.hpp"
#include "tests/algorithms/compute.hpp"
#include "tests/algorithms/rendered.hpp"
#include "tests/algorithms/scenes.hpp"

namespace pellucid {
namespace {

TEST(Shadows, ShaderFunctionsAgreeWithTheirTwins) {
  test::use_context();
  struct Input {
    float mean, mean_square, depth, min_variance, amount, before, at, after;
  };
  // The declared ends and the default of a setting.
  const auto ends = [](std::string_view name) {
    const ParameterInfo& info = *parameter_table<ShadowSettings>().find(name);
    return std::array{static_cast<float>(info.min), static_cast<float>(std::get<double>(info.default_value)),
                      static_cast<float>(info.max)};
  };
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  std::vector<Input> inputs;
  for (int k = 0; k < 4096; ++k) {
    const float mean = unit(random);
    const float spread = k % 5 == 0 ? 0.0F : 0.3F * unit(random);
    // A depth at the mean itself too, where with no variance at all the bound is 0 / 0 but for the first case.
    const float depth = k % 17 == 0 ? mean : unit(random);
    inputs.push_back({mean, mean * mean + spread * spread, depth, ends("min_variance")[static_cast<std::size_t>(k % 3)],
                      k % 7 < 3 ? ends("bleeding")[static_cast<std::size_t>(k % 7)] : 0.95F * unit(random),
                      unit(random), unit(random),
                      k % 11 == 0   ? 0.0F
                      : k % 11 == 1 ? 1.0F
                                    : unit(random)});
  }
  const gl::Program program("shadow twins", {"tests/algorithms/shadows.comp.glsl"});
  const std::vector<glm::vec4> outputs = test::compute<glm::vec4>(program, inputs);
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const Input& q = inputs[k];
    // E[d²] − E[d]² loses digits when the variance is small: an error of 1e-7 in it against (depth − mean)².
    const double behind = std::max(static_cast<double>(q.depth) - static_cast<double>(q.mean), 1e-9);
    EXPECT_NEAR(outputs[k].x, chebyshev_bound(q.mean, q.mean_square, q.depth, q.min_variance),
                1e-5 + std::min(1.0, 2e-7 / (behind * behind)))
        << k;
    EXPECT_NEAR(outputs[k].y, reduce_bleeding(q.after, q.amount), 1e-5) << k;
    EXPECT_NEAR(outputs[k].z, filtered_occlusion(q.before, q.at, q.after), 1e-6) << k;
  }
}

// Half the occluders at depth 0.2 and half at 0.8: a point between sees at most half of the light; the bound is exact
// for two depths when the point lies at the farther one.
TEST(Shadows, ChebyshevIsExactForTwoDepths) {
  const double mean = 0.5, mean_square = 0.5 * (0.04 + 0.64);
  EXPECT_NEAR(chebyshev_bound(mean, mean_square, 0.8, 0), 0.5, 1e-12);
  EXPECT_EQ(chebyshev_bound(mean, mean_square, 0.5, 0), 1.0);
  EXPECT_EQ(reduce_bleeding(0.2, 0.2), 0.0);
  EXPECT_EQ(reduce_bleeding(1.0, 0.2), 1.0);
  EXPECT_DOUBLE_EQ(filtered_occlusion(0.0, 1.0, 0.0), 0.5);
}

// A plate over a floor: under its middle no light, beyond its shadow all of it, for each kind of light.
TEST(Shadows, PlateOverAFloor) {
  test::use_context();
  for (const LightKind kind : {LightKind::directional, LightKind::spot, LightKind::point}) {
    auto frame = [&](bool shadow) {
      Scene scene;
      scene.name = "plate";
      scene.meshes = {make_plane({8.0F, 8.0F}, 1), make_plane({1.0F, 1.0F}, 1)};
      scene.materials.push_back({.name = "white", .albedo = glm::vec3(0.8F)});
      scene.instances.push_back({.name = "floor", .mesh = 0});
      scene.instances.push_back(
          {.name = "plate", .mesh = 1, .to_world = glm::translate(glm::mat4(1.0F), glm::vec3(0.0F, 1.0F, 0.0F))});
      Light light{.name = "light", .kind = kind, .position = {0.0F, 3.0F, 0.0F}, .direction = {0.0F, -1.0F, 0.0F}};
      light.intensity = glm::vec3(kind == LightKind::directional ? 1.0F : 9.0F);
      light.inner_angle_deg = 50.0F;
      light.outer_angle_deg = 60.0F;
      light.casts_shadow = shadow;
      scene.lights.push_back(light);
      Volume fog;
      fog.name = "none";
      fog.density = {0.0F};
      scene.volume = fog;
      // From below the plate's height, so that it does not stand before the floor.
      scene.views.push_back({.name = "v", .eye = {0.0F, 0.6F, 4.0F}, .target = {0.0F, 0.0F, 0.0F}, .fov_y_deg = 50.0F});
      RenderSession session(std::move(scene), "sampling_hulls", "", 160, 120);
      session.assign_text("frame.format", "single");
      gl::PassTimer timer;
      session.render(timer);
      return session.read_color();
    };
    const Image lit = frame(false), shadowed = frame(true);
    auto ratio = [&](int x, int y) { return shadowed.at(x, y)[0] / lit.at(x, y)[0]; };
    EXPECT_NEAR(ratio(80, 60), 0.0F, 0.02F) << static_cast<int>(kind) << ": under the plate";
    EXPECT_NEAR(ratio(10, 62), 1.0F, 0.02F) << static_cast<int>(kind) << ": beyond its shadow";
    EXPECT_NEAR(ratio(150, 62), 1.0F, 0.02F) << static_cast<int>(kind);
    EXPECT_NEAR(ratio(80, 110), 1.0F, 0.02F) << static_cast<int>(kind) << ": before it";
  }
}

}  // namespace
}  // namespace pellucid
