// Where a picture's error lies, by class.
#include "sweeps/measure/errors_by_class.hpp"

#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace pellucid::sweeps {
namespace {

TEST(ClassErrors, SumUpAPicturesErrorByClass) {
  NativeMap map{"hit_class", "class", "of hits", Image(5, 1, 1), {"right", "wrong", "seldom"}};
  map.values.pixels = {0, 1, 0, std::numeric_limits<float>::quiet_NaN(), 1};
  Image flip(5, 1, 1);
  flip.pixels = {0.1F, 0.5F, 0.2F, 0.9F, 0.2F};  // the fourth is of no class
  nlohmann::json row = nlohmann::json::object();
  put_errors_by_class(row, map, flip);
  EXPECT_NEAR(row.at("flip_mean_right").get<double>(), 0.15, 1e-7);
  EXPECT_NEAR(row.at("flip_mean_wrong").get<double>(), 0.35, 1e-7);
  EXPECT_NEAR(row.at("flip_share_right").get<double>(), 0.3, 1e-7);
  EXPECT_NEAR(row.at("flip_share_wrong").get<double>(), 0.7, 1e-7);
  EXPECT_FALSE(row.contains("flip_mean_seldom"));
}

TEST(ClassErrors, SayNothingOfOtherMaps) {
  nlohmann::json row = nlohmann::json::object();
  put_errors_by_class(row, {"hit_error_m", "m", "", Image(2, 1, 1)}, Image(2, 1, 1));
  EXPECT_TRUE(row.empty());
}

TEST(ClassErrors, OfAPerfectPictureHaveNoShares) {
  nlohmann::json row = nlohmann::json::object();
  put_errors_by_class(row, {"hit_class", "class", "", Image(2, 1, 1), {"right"}}, Image(2, 1, 1));
  EXPECT_EQ(row.at("flip_mean_right"), 0.0);
  EXPECT_FALSE(row.contains("flip_share_right"));
}

}  // namespace
}  // namespace pellucid::sweeps
