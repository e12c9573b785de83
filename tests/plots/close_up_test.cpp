// The window of the largest error, enlarged pixels, one contrast for all.
#include "plots/pictures/close_up.hpp"

#include <cstddef>

#include <gtest/gtest.h>

namespace pellucid::plots {
namespace {

TEST(CloseUp, TheWindowLiesWhereTheSumIsLargest) {
  Image map(40, 30, 1);
  *map.at(3, 4) = 0.9F;    // the largest single error…
  *map.at(30, 20) = 0.6F;  // …but these two fit into one window
  *map.at(33, 22) = 0.6F;
  const Window window = brightest_window(map, 8, 6);
  EXPECT_EQ(window.width, 8);
  EXPECT_EQ(window.height, 6);
  EXPECT_LE(window.x, 30);
  EXPECT_GT(window.x + window.width, 33);
  EXPECT_LE(window.y, 20);
  EXPECT_GT(window.y + window.height, 22);
}

TEST(CloseUp, TheWindowAgreesWithAddingUpEveryOne) {
  Image map(17, 13, 1);
  unsigned state = 1;
  for (float& value : map.pixels) {
    state = state * 1664525U + 1013904223U;
    value = static_cast<float>(state >> 8) / static_cast<float>(1U << 24);
  }
  Window best;
  double largest = -1;
  for (int y = 0; y + 4 <= map.height; ++y) {
    for (int x = 0; x + 5 <= map.width; ++x) {
      double sum = 0;
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 5; ++i)
          sum += static_cast<double>(*map.at(x + i, y + j));
      if (sum > largest) {
        largest = sum;
        best = {x, y, 5, 4};
      }
    }
  }
  EXPECT_EQ(brightest_window(map, 5, 4), best);
}

TEST(CloseUp, TheWindowReachesTheLastPixelAndNeverBeyond) {
  Image map(20, 10, 1);
  *map.at(19, 9) = 1;
  const Window corner = brightest_window(map, 6, 5);
  EXPECT_EQ(corner, (Window{14, 5, 6, 5}));
  EXPECT_EQ(brightest_window(map, 100, 100), (Window{0, 0, 20, 10}));
}

TEST(CloseUp, EnlargedPixelsAreSquaresOfThePixelsInTheWindow) {
  Image image(6, 5, 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = static_cast<float>(i);
  const Image out = enlarge(crop(image, {2, 1, 3, 2}), 3);
  ASSERT_EQ(out.width, 9);
  ASSERT_EQ(out.height, 6);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      for (int c = 0; c < 3; ++c)
        EXPECT_EQ(out.at(x, y)[c], image.at(2 + x / 3, 1 + y / 3)[c]);
    }
  }
}

TEST(CloseUp, ContrastStretchesTheReferencesRangeAndLeavesAlpha) {
  Image ramp(101, 1, 4);
  for (int x = 0; x < ramp.width; ++x) {
    for (int c = 0; c < 3; ++c)
      ramp.at(x, 0)[c] = 0.4F + 0.001F * static_cast<float>(x);
    ramp.at(x, 0)[3] = 0.25F;
  }
  const Contrast contrast = contrast_for(ramp);
  const Image out = stretch(ramp, contrast);
  EXPECT_NEAR(out.at(1, 0)[0], 0.1F, 0.01F);
  EXPECT_NEAR(out.at(50, 0)[1], 0.5F, 0.01F);
  EXPECT_NEAR(out.at(99, 0)[2], 0.9F, 0.01F);
  EXPECT_EQ(out.at(50, 0)[3], 0.25F);
}

TEST(CloseUp, AnEvenImageStaysAsItIs) {
  Image even(8, 8, 3);
  for (float& value : even.pixels)
    value = 0.3F;
  EXPECT_EQ(stretch(even, contrast_for(even)).pixels, even.pixels);
}

}  // namespace
}  // namespace pellucid::plots
