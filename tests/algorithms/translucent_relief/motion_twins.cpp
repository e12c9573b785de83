// Waves and drops on the GPU against those of the scene.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/translucent_relief/animation.hpp"
#include "tests/algorithms/relief_scenes.hpp"
#include "tests/algorithms/rendered.hpp"

namespace pellucid {
namespace {

double farthest(const std::vector<float>& a, const std::vector<float>& b) {
  EXPECT_EQ(a.size(), b.size());
  double worst = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    worst = std::max(worst, std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])));
  return worst;
}

gl::Texture map(gl::Format format, int size) {
  return gl::Texture::make_2d("map", format, size, size);
}

TEST(ReliefMotion, WavesAreTheScenes) {
  test::use_context();
  translucent_relief::Animation animation;
  for (const double time_s : {0.0, 1.7, 120.0}) {
    PatternOptions options;
    options.kind = Pattern::waves;
    options.width = options.height = 64;
    options.time_s = time_s;
    ReliefMotion motion;
    motion.sines.resize(static_cast<std::size_t>(options.waves));
    make_sines(options, motion.sines.data());
    motion.time_s = time_s;
    const gl::Texture heights = map(gl::Format::r32f, 64), slopes = map(gl::Format::rg32f, 64);
    animation.run(motion, heights, slopes);
    const Image expected = make_pattern(options).heights;
    EXPECT_LT(farthest(heights.read(), expected.pixels), 2e-4) << time_s;
    EXPECT_LT(farthest(slopes.read(), slopes_of(expected).pixels), 1e-2) << time_s;
  }
}

// Whole numbers: the drops are the same to the last unit after any time, though merging would magnify any difference.
TEST(ReliefMotion, DropsAreTheScenes) {
  test::use_context();
  translucent_relief::Animation animation;
  for (const int steps : {0, 1, 60, 900}) {
    ReliefMotion motion;
    motion.rain = {.seed = 5, .drops = 120, .largest = 220, .fall = 16};
    motion.steps = steps;
    motion.ground_m = test::random_field(64, 3);
    for (float& texel : motion.ground_m.pixels)
      texel = -0.1F + 0.02F * texel;
    motion.below_m = -0.12F;
    motion.top_m = -0.05F;
    motion.height_m = 0.02F;
    const gl::Texture heights = map(gl::Format::r32f, 64), slopes = map(gl::Format::rg32f, 64);
    animation.run(motion, heights, slopes);
    const std::vector<RainDrop> expected = rain_drops(motion.rain, steps), found = animation.read_drops();
    ASSERT_EQ(found.size(), expected.size());
    int merged = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].x, expected[i].x) << i;
      EXPECT_EQ(found[i].y, expected[i].y) << i;
      EXPECT_EQ(found[i].radius, expected[i].radius) << i;
      merged += found[i].life;
    }
    if (steps == 900) {
      EXPECT_GT(merged, 20) << "drops run into each other";
    }
    Image surface = rain_surface(expected, motion.rain, motion.ground_m, motion.below_m, motion.height_m);
    for (float& texel : surface.pixels)
      texel = std::clamp((texel - motion.below_m) / (motion.top_m - motion.below_m), 0.0F, 1.0F);
    EXPECT_LT(farthest(heights.read(), surface.pixels), 1e-4);
  }
}

}  // namespace
}  // namespace pellucid
