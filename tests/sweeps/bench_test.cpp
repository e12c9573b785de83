// Ratios of interleaved blocks.
#include "sweeps/bench/bench.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "sweeps/bench/bench_reference.hpp"

namespace pellucid::sweeps {
namespace {

TEST(BlockRatio, IsTheMedianOfTheBlocksRatios) {
  // Blocks of three: medians 2, 6, 4 over 1, 2, 4.
  const std::vector<double> a{1, 2, 9, 6, 6, 6, 4, 3, 5};
  const std::vector<double> b{1, 1, 1, 2, 9, 1, 4, 4, 4};
  const auto ratio = block_ratio(a, b, {}, 3);
  ASSERT_TRUE(ratio);
  EXPECT_DOUBLE_EQ(ratio->median, 2);
  EXPECT_GE(ratio->ci95.low, 1);
  EXPECT_LE(ratio->ci95.high, 3);
}

TEST(BlockRatio, DoesNotMoveWithADriftThatReachesBoth) {
  std::vector<double> a, b;
  for (int block = 0; block < 8; ++block) {
    const double slower = 1 + block;
    a.insert(a.end(), {3 * slower, 3 * slower});
    b.insert(b.end(), {2 * slower, 2 * slower});
  }
  const auto ratio = block_ratio(a, b, {}, 2);
  ASSERT_TRUE(ratio);
  EXPECT_DOUBLE_EQ(ratio->median, 1.5);
  EXPECT_DOUBLE_EQ(ratio->ci95.low, 1.5);
  EXPECT_DOUBLE_EQ(ratio->ci95.high, 1.5);
}

TEST(BlockRatio, TakesOffWhatBothShare) {
  const auto ratio = block_ratio({7, 7, 7, 7}, {4, 4, 4, 4}, {1, 1, 1, 1}, 2);
  ASSERT_TRUE(ratio);
  EXPECT_DOUBLE_EQ(ratio->median, 2);
}

TEST(BlockRatio, IsNotGivenWhereTheSharedPartIsAllThereIs) {
  EXPECT_FALSE(block_ratio({7, 7, 7, 7}, {4, 4, 1, 1}, {1, 1, 1, 1}, 2));
}

TEST(BlockRatio, OutlivesOneBlockThatNoiseHides) {
  std::vector<double> a(40, 7), b(40, 4), c(40, 1);
  c[0] = c[1] = 9;
  const auto ratio = block_ratio(a, b, c, 2);
  ASSERT_TRUE(ratio);
  EXPECT_DOUBLE_EQ(ratio->median, 2);
  EXPECT_DOUBLE_EQ(ratio->ci95.high, 2);
}

TEST(ReferenceTracer, SetsEachPictureAgainstTheFramesBesideIt) {
  const Scene scene = load_scene("mirror_room");
  const Camera camera{scene.find_view(""), 16, 12};
  SurfaceOptions options;
  options.depth = 1;
  options.samples = 9;  // a pixel's centre is what a frame shows
  ReferenceTracer tracer(scene, camera, options);
  tracer.trace();
  tracer.forget();
  for (int i = 0; i < 3; ++i)
    tracer.trace();
  const BenchReference of_one = tracer.against(std::vector<double>(6, 1.0), 2);
  EXPECT_GT(of_one.trace.median_ms, 0);
  EXPECT_DOUBLE_EQ(of_one.ratio.median, of_one.trace.median_ms);
  EXPECT_DOUBLE_EQ(tracer.against(std::vector<double>(6, 0.5), 2).ratio.median, 2 * of_one.ratio.median);
  EXPECT_EQ(of_one.depth, 1);
  EXPECT_GT(of_one.build_ms, 0);
  EXPECT_GT(of_one.rays_per_pixel, 1);
  EXPECT_LT(of_one.rays_per_pixel, 4) << "one sample a pixel";
}

}  // namespace
}  // namespace pellucid::sweeps
