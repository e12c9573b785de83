// A reference that takes long: stopped half-way it goes on where it was, and done it is not traced again.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "algorithms/reference/reference.hpp"
#include "algorithms/scene/scene.hpp"
#include "tests/algorithms/reference/optical_scenes.hpp"
#include "tests/algorithms/scene/folder_test.hpp"
#include "tests/cloudy_ball.hpp"
#include "tests/gl/gl_fixture.hpp"

namespace pellucid::test {
namespace {

// 48 samples are three times as many as are traced between two looks at the clock.
constexpr int kSamples = 48;

class PartialPictureTest : public FolderTest {
 protected:
  PartialPictureTest() : scene_(load_scene(write("ball.toml", cloudy_ball(1, 0.9)))) {}
  SurfaceLayer traced(const std::function<void(double)>& progress, std::uint32_t seed = 1) const {
    SurfaceOptions options;
    options.seed = seed;
    options.samples = kSamples;
    options.progress = progress;
    return trace_surfaces(scene_, looking({0, 0.2F, 3.4F}, {0, 0, 0}, 16, 40), options);
  }

  Scene scene_;
};

struct Stopped : std::runtime_error {
  Stopped() : std::runtime_error("stopped") {}
};

TEST_F(PartialPictureTest, IsTheSameWhenStoppedAndResumedAndIsKept) {
  SurfaceLayer whole;
  {
    const gl::test::ScopedEnvironment none("PELLUCID_CACHE", "off");
    whole = traced({});
  }
  const gl::test::ScopedEnvironment cache("PELLUCID_CACHE", file("cache").string());
  // The first third takes as long as it takes until something is kept; the second is lost.
  bool waited = false;
  EXPECT_THROW(traced([&](double share) {
                 if (!waited && share > 0.3) {
                   waited = true;
                   std::this_thread::sleep_for(std::chrono::milliseconds(2200));
                 }
                 if (share > 0.5) throw Stopped();
               }),
               Stopped);
  ASSERT_FALSE(std::filesystem::is_empty(file("cache/paths")));

  double least = 1;
  const SurfaceLayer resumed = traced([&](double share) { least = std::min(least, share); });
  EXPECT_GT(least, 1.0 / 3) << "the first third is not traced again";
  EXPECT_EQ(resumed.radiance.pixels, whole.radiance.pixels);
  EXPECT_EQ(resumed.statistics.standard_error_mean, whole.statistics.standard_error_mean);
  EXPECT_EQ(resumed.statistics.samples, whole.statistics.samples);

  bool traced_again = false;
  const SurfaceLayer kept = traced([&](double) { traced_again = true; });
  EXPECT_FALSE(traced_again);
  EXPECT_EQ(kept.radiance.pixels, whole.radiance.pixels);
  traced([&](double) { traced_again = true; }, 2);
  EXPECT_TRUE(traced_again) << "of another seed";
}

}  // namespace
}  // namespace pellucid::test
