#include "algorithms/scene/view_text.hpp"

#include <string>

#include <gtest/gtest.h>

#include "gl/error.hpp"
#include "tests/algorithms/scenes.hpp"
#include "tests/input_error.hpp"

namespace pellucid {
namespace {

Scene scene_with_two_views() {
  Scene scene;
  scene.name = "s";
  scene.views.resize(2);
  scene.views[0].name = "front";
  scene.views[1].name = "side";
  scene.views[1].eye = {7, 0, 0};
  scene.views[1].fov_y_deg = 30;
  return scene;
}

std::string refusal(const std::string& text) {
  return test::input_error([&] { view_of(scene_with_two_views(), text); });
}

TEST(ViewText, ReadsBackBitForBit) {
  View view;
  view.eye = {0.1F, -1.0F / 3, 1e-5F};
  view.target = {3, 2.7182818F, 0};
  view.up = {0, 0.6F, 0.8F};
  view.fov_y_deg = 37.7F;
  view.near_m = 0.017F;
  view.far_m = 123.456F;
  const View read = view_of(scene_with_two_views(), to_view_text(view));
  EXPECT_EQ(read.eye, view.eye);
  EXPECT_EQ(read.target, view.target);
  EXPECT_EQ(read.up, view.up);
  EXPECT_EQ(read.fov_y_deg, view.fov_y_deg);
  EXPECT_EQ(read.near_m, view.near_m);
  EXPECT_EQ(read.far_m, view.far_m);
  EXPECT_EQ(read.name, to_view_text(view));  // so that it is found again by its name
}

TEST(ViewText, TakesWhatIsLeftOutFromTheNamedView) {
  const View from_side = view_of(scene_with_two_views(), "side:target=0,1,0");
  EXPECT_EQ(from_side.eye, glm::vec3(7, 0, 0));
  EXPECT_EQ(from_side.target, glm::vec3(0, 1, 0));
  EXPECT_EQ(from_side.fov_y_deg, 30.0F);
  EXPECT_EQ(view_of(scene_with_two_views(), "fov=60").eye, glm::vec3(0, 0, 5));
}

TEST(ViewText, NamesThePartThatIsWrong) {
  EXPECT_EQ(refusal("eye=1,2"), "view: 'eye=1,2' is not three numbers, for example eye=0,1.5,4");
  EXPECT_EQ(refusal("fov=200"), "view: 'fov=200' is out of range [1, 179]");
  EXPECT_EQ(refusal("targt=1,2,3"), "view: 'targt=1,2,3' is unknown; did you mean 'target='?");
  EXPECT_EQ(refusal("eye=nan,0,0"), "view: 'eye=nan,0,0' is not a number in [-1e6, 1e6]");
  EXPECT_EQ(refusal("eye=0,0,0:target=0,0,0"), "view: 'eye=0,0,0:target=0,0,0' has its target at its eye");
  EXPECT_EQ(refusal("eye=0,5,0:target=0,0,0"), "view: 'eye=0,5,0:target=0,0,0' looks along its up direction");
  EXPECT_EQ(refusal("sid:fov=60"), "unknown view 'sid' of scene 's'; did you mean 'side'?");
}

}  // namespace
}  // namespace pellucid
