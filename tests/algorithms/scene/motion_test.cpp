#include "algorithms/scene/motion.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace pellucid {
namespace {

using Interpolation = MotionPath::Interpolation;

TEST(MotionPath, LinearRunsStraightAndRestsAtItsEnds) {
  const MotionPath path{{{1, {0, 0, 0}}, {3, {2, 4, 0}}, {4, {2, 4, 8}}}, Interpolation::linear, false};
  EXPECT_EQ(path.at(0), glm::dvec3(0, 0, 0));
  EXPECT_EQ(path.at(1.5), glm::dvec3(0.5, 1, 0));
  EXPECT_EQ(path.at(3), glm::dvec3(2, 4, 0));
  EXPECT_EQ(path.at(3.25), glm::dvec3(2, 4, 2));
  EXPECT_EQ(path.at(99), glm::dvec3(2, 4, 8));
}

TEST(MotionPath, ALoopBeginsAgain) {
  const MotionPath path{{{1, {0, 0, 0}}, {2, {1, 0, 0}}, {5, {0, 0, 0}}}, Interpolation::linear, true};
  EXPECT_NEAR(path.at(1.25).x, 0.25, 1e-12);
  EXPECT_NEAR(path.at(5.25).x, 0.25, 1e-12);
  EXPECT_NEAR(path.at(41.25).x, 0.25, 1e-9);
  EXPECT_NEAR(path.at(0).x, path.at(4).x, 1e-12);
}

TEST(MotionPath, CatmullRomMeetsItsKeyframesWithOneSlope) {
  for (const bool loop : {false, true}) {
    const MotionPath path{
        {{0, {0, 0, 0}}, {1, {1, 2, 0}}, {3, {2, -1, 1}}, {4, {0, 0, 0}}}, Interpolation::catmull_rom, loop};
    for (const Keyframe& key : path.keyframes) {
      EXPECT_LT(glm::length(path.at(key.time_s) - key.value), 1e-12);
    }
    constexpr double h = 1e-6;
    for (const double t : {1.0, 3.0}) {
      const glm::dvec3 before = (path.at(t) - path.at(t - h)) / h;
      const glm::dvec3 after = (path.at(t + h) - path.at(t)) / h;
      EXPECT_LT(glm::length(before - after), 1e-4);
    }
    if (loop) {  // smooth across the seam
      EXPECT_LT(glm::length((path.at(4 - h) - path.at(4 - 2 * h)) / h - (path.at(4 + 2 * h) - path.at(4 + h)) / h),
                1e-4);
    }
    // The slope at 1 s is that between its neighbours.
    EXPECT_LT(glm::length((path.at(1 + h) - path.at(1 - h)) / (2 * h) - glm::dvec3(2, -1, 1) / 3.0), 1e-4);
  }
}

TEST(MotionPath, CatmullRomOfAStraightLineIsThatLine) {
  const MotionPath path{{{0, {0, 0, 0}}, {1, {1, 0, 0}}, {4, {4, 0, 0}}}, Interpolation::catmull_rom, false};
  for (double t = 0; t <= 4; t += 0.125)
    EXPECT_NEAR(path.at(t).x, t, 1e-12);
}

TEST(Spin, TurnsRightHanded) {
  const Spin spin{{0, 2, 0}, 90};
  EXPECT_LT(glm::length(spin.at(1) * glm::dvec3(0, 0, 1) - glm::dvec3(1, 0, 0)), 1e-12);
  EXPECT_LT(glm::length(spin.at(4) * glm::dvec3(0, 0, 1) - glm::dvec3(0, 0, 1)), 1e-12);
}

}  // namespace
}  // namespace pellucid
