#include "plots/charts/ticks.hpp"

#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace pellucid::plots {
namespace {

// A label must say the value it stands at: a lost exponent is a wrong number.
TEST(Ticks, LabelsReadBackAsTheirValues) {
  for (double value : {1e-9, 2e-5, 1e-4, 5e-4, 0.001, 0.02, 0.5, 1.0, 20.0, 1000.0, 5e4, 1e7}) {
    EXPECT_NEAR(std::stod(power_label(value)) / value, 1.0, 1e-9) << power_label(value);
  }
  for (double value : {1.0, 2.0, 512.0, 1024.0, 65536.0})
    EXPECT_EQ(std::stod(binary_label(value)), value);
  EXPECT_EQ(binary_label(0.25), "1/4");
  EXPECT_EQ(decimal_label(0.25, 2), "0.25");
  EXPECT_NEAR(std::stod(decimal_label(2.5e7, 0)), 2.5e7, 1e5);
}

TEST(Ticks, AnAxisHasOneNotation) {
  const auto exponents = [](double low, double high) {
    int with = 0, without = 0;
    for (const Tick& tick : lay_out_axis({.label = "x", .scale = Scale::log10}, low, high, 6).ticks) {
      if (!tick.label.empty()) ++(tick.label.find('e') == std::string::npos ? without : with);
    }
    return std::pair(with, without);
  };
  EXPECT_EQ(exponents(2e-4, 0.05).first, 0);
  EXPECT_GE(exponents(2e-4, 0.05).second, 3);
  EXPECT_GE(exponents(1e-9, 1e-6).first, 3);
}

TEST(Ticks, LieInARangeThatHoldsTheData) {
  for (const Scale scale : {Scale::linear, Scale::log2, Scale::log10}) {
    for (const auto& [low, high] :
         {std::pair{1.0, 1024.0}, std::pair{12.0, 88.0}, std::pair{0.003, 0.004}, std::pair{5.0, 5.0}}) {
      const AxisLayout layout = lay_out_axis({.label = "x", .scale = scale}, low, high, 6);
      EXPECT_LE(layout.min, low);
      EXPECT_GE(layout.max, high);
      EXPECT_LT(layout.min, layout.max);
      int labels = 0;
      for (const Tick& tick : layout.ticks) {
        EXPECT_GE(layout.position(tick.value), -1e-9);
        EXPECT_LE(layout.position(tick.value), 1 + 1e-9);
        labels += tick.label.empty() ? 0 : 1;
      }
      // A range within one step has its one label; a decade has several.
      EXPECT_GE(labels, high > 4 * low ? 2 : 1) << low << " to " << high;
    }
  }
}

}  // namespace
}  // namespace pellucid::plots
