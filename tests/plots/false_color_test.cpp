#include "plots/pictures/false_color.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "sweeps/metrics/flip.hpp"

namespace pellucid::plots {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

Image map_of(const std::vector<float>& values) {
  Image out(static_cast<int>(values.size()), 1, 1);
  out.pixels = values;
  return out;
}

TEST(FalseColors, EndAtARoundNumberAboveNearlyAllValues) {
  std::vector<float> values;
  for (int i = 0; i <= 1000; ++i)
    values.push_back(0.00003F * static_cast<float>(i));
  values.push_back(7.0F);  // one in a thousand does not darken the rest
  EXPECT_EQ(color_range({}), 1);
  const Image ramp = map_of(values), three = map_of({kNone, 3.0F, 3.0F}), two = map_of({2.0F, 2.0F});
  EXPECT_EQ(color_range({&ramp}), 0.05);
  EXPECT_EQ(color_range({&three}), 5);
  EXPECT_EQ(color_range({&two}), 2) << "a round number is its own end";
  EXPECT_EQ(color_range({&ramp, &three, &two}), 5) << "the largest of several maps";
  const Image nothing = map_of({kNone, kNone}), zero = map_of({0.0F, 0.0F}), tiny = map_of({0.0061F});
  EXPECT_EQ(color_range({&nothing}), 1);
  EXPECT_EQ(color_range({&zero}), 1);
  EXPECT_EQ(color_range({&tiny}), 0.01);
}

TEST(FalseColors, AreThoseOfErrorMapsAndGreyWithoutAValue) {
  const Image colors = false_colors(map_of({0.0F, 0.01F, 0.02F, 9.0F, kNone}), 0.02);
  ASSERT_EQ(colors.channels, 3);
  const Image expected = sweeps::error_colors(map_of({0.0F, 0.5F, 1.0F, 1.0F, 0.0F}));
  for (int x = 0; x < 4; ++x) {
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(colors.at(x, 0)[c], expected.at(x, 0)[c], 1e-6F) << x;
  }
  EXPECT_EQ(colors.at(4, 0)[0], colors.at(4, 0)[1]);
  EXPECT_EQ(colors.at(4, 0)[0], colors.at(4, 0)[2]);
  EXPECT_GT(colors.at(4, 0)[0], 0.3F);
  EXPECT_LT(colors.at(4, 0)[0], 0.8F);
}

}  // namespace
}  // namespace pellucid::plots
