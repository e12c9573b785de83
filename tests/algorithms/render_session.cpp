// The session gives every technique this: supersampling, and the refusal of objects it cannot draw.
#include "algorithms/render_session.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "gl/context.hpp"
#include "gl/live_objects.hpp"
#include "tests/algorithms/scenes.hpp"

namespace pellucid {
namespace {

Image frame(int width, int height, const char* supersampling) {
  RenderSession session(test::fog_box_with_ball({4, 4, 4}, 0.75F, 0.9F), "ray_marching", "front", width, height);
  session.assign_text("frame.format", "single");
  session.assign_text("frame.supersampling", supersampling);
  gl::PassTimer timer;
  session.render(timer);
  return session.read_color();
}

// The samples lie on the pixel grid of the larger frame, so only the rounding of a mean remains.
TEST(SharedFrame, SupersamplesAsTheMeanOfALargerFrame) {
  const gl::Context context;
  const Image small = frame(24, 18, "3"), large = frame(72, 54, "1");
  ASSERT_EQ(small.width, 24);
  ASSERT_EQ(small.height, 18);
  double contrast = 0;
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      for (int c = 0; c < 4; ++c) {
        double mean = 0;
        for (int j = 0; j < 9; ++j)
          mean += static_cast<double>(large.at(3 * x + j % 3, 3 * y + j / 3)[c]) / 9.0;
        EXPECT_NEAR(static_cast<double>(small.at(x, y)[c]), mean, 1e-6);
        contrast = std::max(contrast, std::abs(mean - static_cast<double>(large.at(3 * x + 1, 3 * y + 1)[c])));
      }
    }
  }
  EXPECT_GT(contrast, 0.01) << "an image without edges tells nothing";
}

TEST(SharedFrame, SupersamplingBeyondTheDeviceIsRefused) {
  const gl::Context context;
  const int limit = gl::limits().max_texture_size;
  RenderSession session(test::fog_box({4, 4, 4}, 0.75F, 0.9F), "ray_marching", "front", limit / 2, 4);
  session.assign_text("frame.supersampling", "4");
  gl::PassTimer timer;
  try {
    session.render(timer);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("frame.supersampling = 4"), std::string::npos) << error.what();
  }
}

// Instances gathered for a camera that looks elsewhere now, and targets of settings of before, are freed with the next
// frame.
TEST(SharedFrame, KeepsNothingThatTheFrameDoesNotUse) {
  const gl::Context context;
  RenderSession session(test::fog_box_with_ball({4, 4, 4}, 0.75F, 0.9F), "ray_marching", "front", 24, 18);
  gl::PassTimer timer;
  session.render(timer);
  const gl::LiveObjects first = gl::count_live_objects();
  const View front = session.camera().view;
  for (int i = 1; i <= 5; ++i) {
    View turned = front;
    turned.eye.x += 0.1F * static_cast<float>(i);
    session.set_view(turned);
    session.assign_text("frame.supersampling", i == 2 ? "2" : "1");
    session.render(timer);
  }
  EXPECT_EQ(gl::growth(first, gl::count_live_objects()), "");
}

TEST(SharedFrame, MediaTechniquesRefuseOpticalObjects) {
  const gl::Context context;
  Scene scene = test::fog_box_with_ball({4, 4, 4}, 0.75F, 0.9F);
  scene.materials[0].kind = SurfaceKind::dielectric;
  try {
    const RenderSession session(std::move(scene), "sampling_hulls", "front", 8, 8);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("'ball'"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace pellucid
