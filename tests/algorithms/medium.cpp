// The techniques over a medium share this.
#include "algorithms/media/medium.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "algorithms/raster/shadow_maps.hpp"
#include "tests/algorithms/rendered.hpp"
#include "tests/algorithms/scenes.hpp"

namespace pellucid {
namespace {

TEST(BoxGeometry, IsCutOnlyWhenSomethingChanged) {
  test::use_context();
  Scene scene = test::fog_box({2, 2, 2}, 1.0F, 1.0F);
  Volume& volume = *scene.volume;
  Camera camera{scene.views[0], 64, 48};
  BoxGeometry box;
  EXPECT_TRUE(box.fit(volume, camera, BoxCut::hulls, 4));
  EXPECT_EQ(box.pieces(), 4);
  EXPECT_FALSE(box.fit(volume, camera, BoxCut::hulls, 4));
  camera.width = 32;  // the pieces do not depend on it
  EXPECT_FALSE(box.fit(volume, camera, BoxCut::hulls, 4));
  EXPECT_TRUE(box.fit(volume, camera, BoxCut::hulls, 3));
  EXPECT_EQ(box.pieces(), 3);
  EXPECT_TRUE(box.fit(volume, camera, BoxCut::image_slices, 3));
  EXPECT_EQ(box.pieces(), 1);
  camera.view.near_m *= 2;
  EXPECT_TRUE(box.fit(volume, camera, BoxCut::image_slices, 3));
  camera.view.eye.x += 0.1F;
  EXPECT_TRUE(box.fit(volume, camera, BoxCut::image_slices, 3));
  volume.to_world[3].y += 0.1F;
  EXPECT_TRUE(box.fit(volume, camera, BoxCut::image_slices, 3));
  camera.view = scene.find_view("behind");
  EXPECT_TRUE(box.fit(volume, camera, BoxCut::hulls, 4));
  EXPECT_EQ(box.pieces(), 0);
}

TEST(BoxGeometry, TellsWhatASliceStandsFor) {
  test::use_context();
  const Scene scene = test::fog_box({2, 2, 2}, 1.0F, 1.0F);
  const Camera camera{scene.views[0], 64, 48};
  BoxGeometry box;
  for (const BoxCut cut : {BoxCut::image_slices, BoxCut::object_slices}) {
    box.fit(*scene.volume, camera, cut, 8);
    const float once = box.slab_m();
    EXPECT_NEAR(glm::length(box.slab_axis()), 1.0F, 1e-6F);
    box.fit(*scene.volume, camera, cut, 16);
    EXPECT_NEAR(box.slab_m(), once / 2, 1e-6F);
  }
}

TEST(ShadowLayers, AreOneForAMapAndSixForACube) {
  std::vector<Light> lights(4);
  lights[0] = {.name = {}, .kind = LightKind::point, .casts_shadow = true};
  lights[1] = {.name = {}, .kind = LightKind::spot};
  lights[2] = {.name = {}, .kind = LightKind::directional, .casts_shadow = true};
  lights[3] = {.name = {}, .kind = LightKind::spot, .casts_shadow = true};
  EXPECT_EQ(shadow_layers(lights), (std::vector<int>{0, -1, 6, 7}));
  EXPECT_FALSE(lit_beyond_map(lights[3]));
  lights[3].outer_angle_deg = 90;
  EXPECT_TRUE(lit_beyond_map(lights[3]));
}

// One hull over the whole box takes the points of one-pass marching: the first writes its points out up to eight and
// loops over more, the second always loops, and their paths come by different ways.
TEST(MediumPath, HullsAndMarchingTakeTheSamePoints) {
  auto make = [] {
    Scene scene = test::fog_box_with_ball({24, 24, 24}, 1.0F, 0.8F);
    scene.volume->density = make_fog_density({24, 24, 24}, {.seed = 3, .octaves = 2});
    for (const LightKind kind : {LightKind::spot, LightKind::point, LightKind::directional}) {
      Light light{.name = "light", .kind = kind, .position = {0.3F, 2.5F, 0.4F}, .direction = {0.0F, -1.0F, 0.0F}};
      light.intensity = glm::vec3(kind == LightKind::directional ? 1.0F : 8.0F);
      light.casts_shadow = true;
      scene.lights.push_back(light);
    }
    return scene;
  };
  for (const char* samples : {"1", "8", "9"}) {
    const Image hulls = test::frame(
        make(),
        {.values = {{"hulls", "1"}, {"samples", samples}, {"coordinates", "single"}, {"frame.format", "single"}}});
    const Image marched =
        test::frame(make(), {.technique = "ray_marching",
                             .values = {{"samples", samples}, {"sample_offset", "0"}, {"frame.format", "single"}}});
    const test::Difference d = test::difference(hulls, marched);
    EXPECT_LT(d.mean, 2e-5) << samples;
    EXPECT_LT(d.max, 2e-2) << samples << ": a pixel of the box's outline, or of a shadow's edge";
  }
}

}  // namespace
}  // namespace pellucid
