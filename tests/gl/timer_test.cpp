#include "gl/timer.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include <epoxy/gl.h>

#include "gl/objects.hpp"
#include "gl/program.hpp"
#include "tests/gl/gl_fixture.hpp"

namespace pellucid::gl::test {
namespace {

static_assert(std::is_nothrow_move_constructible_v<PassTimer> && std::is_nothrow_move_assignable_v<PassTimer>);
static_assert(!std::is_copy_constructible_v<PassTimer>);

/// A full-screen draw whose cost grows with the number of iterations.
class Load {
 public:
  void draw(int iterations) const {
    framebuffer_.bind();
    program_.use();
    program_.set("iterations", iterations);
    triangle_.bind();
    glDrawArrays(GL_TRIANGLES, 0, 3);
    check("draw", "load");
  }
  float first_value() const { return color_.read().at(0); }

 private:
  Texture color_ = Texture::make_2d("load", Format::r32f, 128, 128);
  Framebuffer framebuffer_{"load", {&color_}};
  Program program_{"load", {"gl/display/display.vert.glsl", "tests/gl/load.frag.glsl"}};
  VertexArray triangle_{"load"};
};

double sum(const FrameTime& time) {
  return std::accumulate(time.pass_ms.begin(), time.pass_ms.end(), 0.0,
                         [](double total, const auto& pass) { return total + pass.second; });
}

class TimerTest : public GlTest, public testing::WithParamInterface<Clock> {};

TEST_P(TimerTest, NamesItsPassesInOrderAndAddsThoseThatRepeat) {
  const Load load;
  PassTimer timer(Detail::passes, GetParam());
  EXPECT_EQ(timer.clock(), GetParam());
  timer.begin_frame();
  for (const char* name : {"hulls", "shade", "hulls"}) {
    const PassTimer::Pass pass = timer.pass(name);
    load.draw(10);
  }
  timer.end_frame();
  const std::optional<FrameTime> time = timer.wait();
  ASSERT_TRUE(time.has_value());
  ASSERT_EQ(time->pass_ms.size(), 2U);
  EXPECT_EQ(time->pass_ms[0].first, "hulls");
  EXPECT_EQ(time->pass_ms[1].first, "shade");
  for (const auto& [name, ms] : time->pass_ms)
    EXPECT_GE(ms, 0.0) << name;
  EXPECT_GE(time->frame_ms + 1e-9, sum(*time));
  EXPECT_FALSE(timer.poll().has_value());
  EXPECT_FALSE(timer.wait().has_value());
}

TEST_P(TimerTest, KeepsManyFramesInFlightAndGivesThemInOrder) {
  const Load load;
  PassTimer timer(Detail::passes, GetParam());
  for (int frame = 0; frame < 40; ++frame) {
    timer.begin_frame();
    {
      const PassTimer::Pass pass = timer.pass(std::to_string(frame));
      load.draw(1);
    }
    timer.end_frame();
  }
  for (int frame = 0; frame < 40; ++frame) {
    const std::optional<FrameTime> time = timer.wait();
    ASSERT_TRUE(time.has_value());
    EXPECT_EQ(time->pass_ms.at(0).first, std::to_string(frame));
  }
  EXPECT_FALSE(timer.wait().has_value());
}

TEST_P(TimerTest, PollGivesAFrameOnceItIsDone) {
  const Load load;
  PassTimer timer(Detail::frame, GetParam());
  EXPECT_FALSE(timer.poll().has_value());
  timer.begin_frame();
  load.draw(10);
  EXPECT_FALSE(timer.poll().has_value());  // not ended
  timer.end_frame();
  glFinish();
  std::optional<FrameTime> time;
  for (int attempt = 0; attempt < 1000 && !time; ++attempt)
    time = timer.poll();
  ASSERT_TRUE(time.has_value());
  EXPECT_TRUE(time->pass_ms.empty());
}

TEST_P(TimerTest, TimesNoPassesUnlessAskedTo) {
  const Load load;
  PassTimer timer(Detail::frame, GetParam());
  timer.begin_frame();
  {
    const PassTimer::Pass pass = timer.pass("ignored");
    load.draw(1);
  }
  timer.end_frame();
  const std::optional<FrameTime> time = timer.wait();
  ASSERT_TRUE(time.has_value());
  EXPECT_TRUE(time->pass_ms.empty());
}

TEST_P(TimerTest, DropsAFrameThatAnExceptionCutShort) {
  PassTimer timer(Detail::passes, GetParam());
  try {
    timer.begin_frame();
    const PassTimer::Pass pass = timer.pass("broken");
    throw RuntimeError("in the middle of a pass");
  } catch (const RuntimeError&) {
  }
  timer.begin_frame();
  { const PassTimer::Pass pass = timer.pass("whole"); }
  timer.end_frame();
  const std::optional<FrameTime> time = timer.wait();
  ASSERT_TRUE(time.has_value());
  ASSERT_EQ(time->pass_ms.size(), 1U);
  EXPECT_EQ(time->pass_ms[0].first, "whole");
  EXPECT_FALSE(timer.wait().has_value());
}

TEST_P(TimerTest, AMovedFromTimerIsOff) {
  PassTimer first(Detail::frame, GetParam());
  first.begin_frame();
  first.end_frame();
  PassTimer second = std::move(first);
  EXPECT_TRUE(second.wait().has_value());
  first.begin_frame();  // NOLINT(bugprone-use-after-move): moved-from means off
  first.end_frame();
  EXPECT_FALSE(first.wait().has_value());
}

INSTANTIATE_TEST_SUITE_P(Clocks, TimerTest, testing::Values(Clock::gpu_query, Clock::finish),
                         [](const auto& instance) { return name(instance.param); });

using TimerChoiceTest = GlTest;

TEST_F(TimerChoiceTest, OffMeasuresNothing) {
  PassTimer timer;
  timer.begin_frame();
  { const PassTimer::Pass pass = timer.pass("nothing"); }
  timer.end_frame();
  EXPECT_FALSE(timer.poll().has_value());
  EXPECT_FALSE(timer.wait().has_value());
}

TEST_F(TimerChoiceTest, CpuRasterisersAreTimedWithFinish) {
  const PassTimer timer(Detail::frame);
  EXPECT_EQ(timer.clock(), software_renderer() ? Clock::finish : Clock::gpu_query);
}

TEST_F(TimerChoiceTest, AHeavyDrawTakesLongerThanAnEmptyPassAndIsSeenByTheWallClock) {
  const Load load;
  load.draw(1);  // compile, allocate
  PassTimer timer(Detail::passes);
  // The least of three, since another process may get in between.
  double empty_ms = 1e9, heavy_ms = 1e9, seen = 0;
  for (int repeat = 0; repeat < 3; ++repeat) {
    glFinish();
    const auto start = std::chrono::steady_clock::now();
    timer.begin_frame();
    { const PassTimer::Pass pass = timer.pass("empty"); }
    {
      const PassTimer::Pass pass = timer.pass("heavy");
      load.draw(1000);
    }
    timer.end_frame();
    const std::optional<FrameTime> time = timer.wait();
    glFinish();  // the wall clock sees all the work, whatever the timer saw
    const double wall_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    ASSERT_TRUE(time.has_value());
    EXPECT_GE(time->frame_ms, time->pass_ms.at(1).second);
    EXPECT_LE(time->frame_ms, wall_ms);
    empty_ms = std::min(empty_ms, time->pass_ms.at(0).second);
    heavy_ms = std::min(heavy_ms, time->pass_ms.at(1).second);
    seen = std::max(seen, time->frame_ms / wall_ms);
  }
  EXPECT_GT(load.first_value(), 0.0F);
  EXPECT_GT(heavy_ms, 5 * empty_ms);
  // The draw is nearly all that happened: a clock that only sees commands being queued would miss it.
  EXPECT_GT(seen, 0.3);
}

}  // namespace
}  // namespace pellucid::gl::test
