// Colours in the panel: three parameters, one control.
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gl/error.hpp"
#include "sandbox/viewer/state/colors.hpp"
#include "tests/viewer/window.hpp"

namespace pellucid::sandbox {
namespace {

using nlohmann::json;
using test::ViewerWindow;

TEST(Colors, AreThreeParametersInARow) {
  std::vector<ParameterInfo> infos(4);
  for (std::size_t i = 0; i < 4; ++i) {
    infos[i].name = std::vector<std::string>{"other", "lamp_red", "lamp_green", "lamp_blue"}[i];
    infos[i].max = 5;
  }
  EXPECT_EQ(color_at(infos, 0), "");
  EXPECT_EQ(color_at(infos, 1), "lamp");
  EXPECT_EQ(color_at(infos, 2), "");
  infos[3].max = 4;  // the pad has one scale for all
  EXPECT_EQ(color_at(infos, 1), "");
}

TEST(Colors, GoToHueAndBack) {
  for (const glm::dvec3 rgb :
       {glm::dvec3(0.9, 0.35, 0.45), glm::dvec3(0, 3, 1), glm::dvec3(0.1, 0.2, 7), glm::dvec3(2)}) {
    const glm::dvec3 again = from_hue(to_hue(rgb));
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(again[c], rgb[c], 1e-12 * 7);  // rounding
  }
  EXPECT_NEAR(to_hue({0, 1, 0}).hue, 1.0 / 3, 1e-15);
  EXPECT_EQ(to_hue({0, 0, 0}).value, 0);
}

TEST(Colors, AreReadAsNumbersGreyOrHex) {
  EXPECT_EQ(parse_color("0.1, 2 3e-1"), glm::dvec3(0.1, 2, 0.3));
  EXPECT_EQ(parse_color("4"), glm::dvec3(4));
  const glm::dvec3 hex = parse_color("#ff8000");
  EXPECT_EQ(hex.x, 1);
  EXPECT_NEAR(hex.y, 0.215861, 1e-6);  // IEC 61966-2-1 at 128/255
  EXPECT_EQ(hex.z, 0);
  EXPECT_EQ(parse_color(color_text({0.1, 0.25, 3})), glm::dvec3(0.1, 0.25, 3));
  for (const char* wrong : {"", "1, 2", "1 2 3 4", "red", "#ff80", "#ff80zz", "1;2;3", "nan 0 0"})
    EXPECT_THROW(parse_color(wrong), InputError) << wrong;
}

TEST(Colors, AreChangedByMouseByKeysAndByText) {
  std::string why;
  if (test::XServer::get(why) == nullptr) GTEST_SKIP() << why;
  test::TemporaryFolder folder;
  std::string text = test::read_file(test::write_small_scene(folder));
  text +=
      "\n[parameters.fog]\ndefault = [0.9, 0.9, 0.9]\nrange = [0, 1]\ndoc = \"albedo\"\ndrives = [\"volume.albedo\"]\n";
  const std::string scene = folder.write("colored.scene.toml", text).string();
  ViewerWindow window({scene, "-t", "volume_slices", "--size", "48x36"}, folder);
  window.wait_picture();
  const auto channel = [](const json& recipe, const char* name) {
    return ViewerWindow::value(recipe, std::string("scene.fog_") + name).get<double>();
  };
  // The top left corner is almost pure red, as bright as before.
  const auto [x, y, width, height] = window.place("scene.fog");
  EXPECT_GT(height, 30) << "there is room to choose a saturation";
  window.click_at(x + 3, y + 3);
  window.wait_picture([&](const json& recipe) {
    return channel(recipe, "red") == 0.9 && channel(recipe, "green") < 0.3 && channel(recipe, "blue") < 0.3;
  });
  window.screenshot("color.png");
  // Keys: less saturation, so more of the others.
  window.keys("shift+Down", 5);
  window.wait_picture(
      [&](const json& recipe) { return channel(recipe, "red") == 0.9 && channel(recipe, "blue") > 0.4; });
  // Text, and a refusal that changes nothing.
  window.tab_to("scene.fog field");
  window.type("0.5, 0.25, 1");
  window.key("Return");
  window.wait_picture([&](const json& recipe) {
    return channel(recipe, "red") == 0.5 && channel(recipe, "green") == 0.25 && channel(recipe, "blue") == 1;
  });
  const int row = window.place("row scene.fog")[3];
  window.key("ctrl+a");
  window.type("0.5, 0.25, 2");
  window.key("Return");
  window.wait_until("the reason", [&] { return window.place("row scene.fog")[3] > row + 8; });
  // Each channel is a parameter like any other.
  window.tab_to("scene.fog_green");
  window.key("Home");
  window.wait_picture(
      [&](const json& recipe) { return channel(recipe, "red") == 0.5 && channel(recipe, "green") == 0; });
}

}  // namespace
}  // namespace pellucid::sandbox
