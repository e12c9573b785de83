#include "tests/viewer/window.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/technique.hpp"
#include "tests/glass_ball.hpp"

namespace pellucid::test {
namespace {

using nlohmann::json;

class Window : public testing::Test {
 protected:
  void SetUp() override {
    std::string why;
    if (XServer::get(why) == nullptr) GTEST_SKIP() << why;
  }
  TemporaryFolder folder_;
  std::string fog_ = write_small_scene(folder_).string();
  std::string glass_ = folder_.write("glass.scene.toml", kGlassBall).string();
};

TEST_F(Window, OpensEachTechniqueWithItsParameters) {
  for (const auto& [scene, interfaces] : {std::pair{fog_, false}, {glass_, true}}) {
    std::string first;
    int count = 0;
    for (const TechniqueInfo& info : techniques()) {
      if (info.interfaces != interfaces) continue;
      if (first.empty()) first = info.name;
      ++count;
    }
    ViewerWindow window({scene, "-t", first, "--size", "96x72"}, folder_);
    window.wait_picture();
    int drawn = 1;
    for (std::size_t i = 1; i < techniques().size(); ++i) {
      window.key("t");
      // The picture, or the reason why this technique cannot draw this scene.
      const json event = window.wait("picture or reason", [&](const json& e) {
        return (e.at("event") == "picture" && !e.at("stale").get<bool>()) ||
               (e.at("event") == "status" &&
                e.at("words").get<std::string>().find("(the picture is the last one)") != std::string::npos);
      });
      if (event.at("event") == "picture") {
        ++drawn;
        const std::string name = event.at("recipe").at("technique");
        for (const ParameterInfo& info : find_technique(name).table().infos())
          window.wait_until(name + " " + info.name, [&] { return window.shows(info.name); });
      }
    }
    EXPECT_GE(drawn, count) << scene;
    window.close();
    EXPECT_FALSE(window.running());
  }
}

TEST_F(Window, IsChangedByTheMouse) {
  const Outcome headless =
      pellucid({"render", fog_, "-t", "sampling_hulls", "--size", "96x72", "-o", (folder_ / "t.png").string()});
  ASSERT_TRUE(succeeded(headless));
  const Image truth = read_image(folder_ / "t.png").image;
  ViewerWindow window({fog_, "-t", "sampling_hulls", "--size", "96x72"}, folder_);
  window.wait_picture();
  // The screen shows the headless picture within 8 bits.
  const json drawn =
      window.wait("drawing", [](const json& e) { return e.at("event") == "drawn" && e.at("generation") > 0; });
  const Image screen = window.screenshot("shown.png");
  const auto region = drawn.at("region").get<std::array<int, 4>>();
  ASSERT_EQ(drawn.at("scale"), 1.0);
  const int x = region[0] - drawn.at("left").get<int>(), y = region[1] - drawn.at("top").get<int>();
  float worst = 0;
  for (int row = 0; row < truth.height; ++row)
    for (int column = 0; column < truth.width; ++column)
      for (int c = 0; c < 3; ++c)
        worst = std::max(worst, std::abs(truth.at(column, row)[c] - screen.at(x + column, y + row)[c]));
  EXPECT_LE(worst, 1.01F / 255);  // the GPU's and the CPU's transform may round to neighbouring codes
  // Around it lies the window's ground, up to the picture's edge.
  for (const auto& [right, down] :
       {std::pair{-1, 0}, {truth.width, truth.height - 1}, {0, -1}, {truth.width - 1, truth.height}})
    EXPECT_NEAR(screen.at(x + right, y + down)[0], 0.11F, 1.01F / 255) << right << ", " << down;

  // Integer: the slider's right end.
  window.drag("hulls", 0.3, 0.99);
  window.wait_picture([](const json& recipe) { return ViewerWindow::value(recipe, "hulls") == 64; });
  // Real of the scene.
  window.drag("scene.density", 0.5, 0.01);
  window.wait_picture([](const json& recipe) { return ViewerWindow::value(recipe, "scene.density") == 0.0; });
  // Choice: open the list, pick its third line.
  window.click("coordinates");
  window.wait("the list",
              [](const json& event) { return event.at("event") == "places" && event.at("widgets").contains("list"); });
  const auto list = window.place("list");
  window.click_at(list[0] + 20, list[1] + list[3] * 5 / 6);
  window.wait_picture([](const json& recipe) { return ViewerWindow::value(recipe, "coordinates") == "single"; });
  // Boolean.
  window.click("filter_occlusion");
  window.wait_picture([](const json& recipe) { return ViewerWindow::value(recipe, "filter_occlusion") == false; });

  for (const auto& [width, height] : {std::pair{300, 200}, {3000, 1600}}) {
    window.resize(width, height);
    window.wait("drawing",
                [&, w = width](const json& e) { return e.at("event") == "drawn" && e.at("framebuffer").at(0) == w; });
    const Image resized = window.screenshot(std::to_string(width) + ".png");
    EXPECT_EQ(resized.width, width);
    EXPECT_EQ(resized.height, height);
  }
}

TEST_F(Window, IsChangedByTheKeyboardAlone) {
  ViewerWindow window({fog_, "-t", "sampling_hulls", "--size", "96x72"}, folder_);
  window.wait_picture();
  // Every section open, so that every widget can be seen.
  for (const char* folded :
       {"headline frame", "headline shadow", "headline Compare", "headline Live figures and sweeps", "headline Display",
        "headline Out", "headline Numbered frames"}) {
    window.tab_to(folded);
    window.key("Right");
  }
  window.wait("the last section",
              [](const json& e) { return e.at("event") == "places" && e.at("widgets").contains("Render frames"); });
  std::set<std::string> expected;
  for (const std::string& id : window.widgets())
    if (!id.starts_with("row ") && !id.starts_with("section ")) expected.insert(id);
  // Round the ring once forwards, headlines included, and once backwards.
  const auto round = [&](const char* key) {
    std::vector<std::string> visited;
    window.keys(key, static_cast<int>(expected.size()));
    while (visited.size() < expected.size())
      visited.push_back(window.wait("a focus", [](const json& e) { return e.at("event") == "focus"; }).at("id"));
    return visited;
  };
  std::vector<std::string> forwards = round("Tab"), backwards = round("shift+Tab");
  EXPECT_EQ(std::set<std::string>(forwards.begin(), forwards.end()), expected);
  // It ends where it began: the way back sees the same widgets in the opposite order, the last one last.
  std::reverse(backwards.begin(), backwards.end());
  std::rotate(backwards.begin(), backwards.begin() + 1, backwards.end());
  std::rotate(forwards.begin(), std::find(forwards.begin(), forwards.end(), backwards.front()), forwards.end());
  EXPECT_EQ(forwards, backwards);

  // A slider: arrows, and a typed value.
  window.tab_to("hulls");
  window.key("Home");
  window.wait_picture([](const json& recipe) { return ViewerWindow::value(recipe, "hulls") == 1; });
  window.key("Right");
  window.wait_picture([](const json& recipe) { return ViewerWindow::value(recipe, "hulls") == 2; });
  const auto before = window.place("row hulls");
  window.type("99");
  window.key("Return");
  // It is refused: the row grows by the reason, and 99 is never drawn.
  window.wait("a higher row", [&](const json& event) {
    return event.at("event") == "places" && event.at("widgets").at("row hulls").at(3) > before[3] + 8;
  });
  window.key("ctrl+a");
  window.type("7");
  window.key("Return");
  window.wait_picture([](const json& recipe) { return ViewerWindow::value(recipe, "hulls") == 7; });
  for (const json& event : window.events()) {
    if (event.at("event") == "picture") {
      EXPECT_NE(ViewerWindow::value(event.at("recipe"), "hulls"), 99);
    }
  }
  window.wait_until("the row as it was", [&] { return window.place("row hulls")[3] == before[3]; });
  // Back with Shift+Tab.
  window.key("shift+Tab");
  window.wait("the slider's focus", [](const json& e) { return e.at("event") == "focus" && e.at("id") == "hulls"; });
  // A check box, a choice by its list, and the technique by typing a part of its name.
  window.tab_to("filter_occlusion");
  window.key("space");
  window.wait_picture([](const json& recipe) { return ViewerWindow::value(recipe, "filter_occlusion") == false; });
  window.tab_to("coordinates");
  window.key("Down");
  window.wait_picture([](const json& recipe) { return ViewerWindow::value(recipe, "coordinates") != "atlas"; });
  window.tab_to("technique");
  window.key("Return");
  window.type("march");
  window.key("Return");
  window.wait_picture([](const json& recipe) { return recipe.at("technique") == "ray_marching"; });

  // Nothing happens from here on, and nothing is computed: 2 % of a core are 6 ticks of 10 ms in 3 s.
  window.key("Escape");
  std::this_thread::sleep_for(std::chrono::seconds(1));
  const auto ticks = [&] {
    std::ifstream file("/proc/" + std::to_string(window.pid()) + "/stat");
    std::string word;
    long used = 0;
    for (int i = 1; i <= 15 && file >> word; ++i)
      if (i == 14 || i == 15) used += std::stol(word);
    return used;
  };
  const long used = ticks();
  std::this_thread::sleep_for(std::chrono::seconds(3));
  EXPECT_LE(ticks() - used, 6);
}

TEST_F(Window, SavesTheHeadlessPictureAndOpensItAgain) {
  const std::vector<std::string> how{fog_,     "-t",   "sampling_hulls", "-s",   "hulls=3",
                                     "--view", "side", "--size",         "96x72"};
  {
    ViewerWindow window(how, folder_);
    window.wait_picture();
    // The camera by hand: the recipe must hold it.
    window.xdotool({"mousemove", "600", "200", "mousedown", "1", "mousemove", "640", "215", "mouseup", "1"});
    window.wait_picture([](const json& recipe) { return recipe.at("view").get<std::string>().find("eye=") == 0; });
    window.key("ctrl+s");
    window.wait("saved", [](const json& event) { return event.at("event") == "saved"; });
    // The same on the clipboard, as EXR.
    window.key("ctrl+shift+c");
    window.wait("copied", [](const json& e) { return e.at("event") == "copied"; });
    const std::string out = (folder_ / "clip.exr").string();
    ASSERT_TRUE(succeeded(run({"sh", "-c", "exec xclip -selection clipboard -t image/x-exr -o > '" + out + "'"},
                              {.environment = {{"DISPLAY", window.display()}}})));
    // And as PNG, which is the one that is saved.
    window.key("ctrl+c");
    window.wait("copied", [](const json& e) { return e.at("event") == "copied"; });
    const std::string png = (folder_ / "clip.png").string();
    ASSERT_TRUE(succeeded(run({"sh", "-c", "exec xclip -selection clipboard -t image/png -o > '" + png + "'"},
                              {.environment = {{"DISPLAY", window.display()}}})));
    window.key("ctrl+shift+s");
    window.wait("saved", [](const json& event) { return event.at("event") == "saved"; });
    window.key("c");
    const std::string command =
        window.wait("copied", [](const json& e) { return e.at("event") == "copied"; }).at("text");
    // The command line makes the same picture, bit for bit.
    const Outcome shell = run({"sh", "-c", std::string(PELLUCID_PROGRAM) + command.substr(command.find(' '))},
                              {.folder = folder_.path()});
    ASSERT_TRUE(succeeded(shell)) << command;
  }
  const ImageFile saved = read_image(folder_ / "small.scene_sampling_hulls_001.exr");
  const ImageFile headless = read_image(folder_ / "picture.exr");
  EXPECT_EQ(saved.image.pixels, headless.image.pixels);
  const ImageFile copied = read_image(folder_ / "clip.exr");
  EXPECT_EQ(copied.image.pixels, saved.image.pixels);
  EXPECT_EQ(copied.attributes.at("pellucid.recipe"), saved.attributes.at("pellucid.recipe"));
  const auto png_name = [&] {
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      if (entry.path().extension() == ".png" && entry.path().filename() != "clip.png") return entry.path();
    return std::filesystem::path();
  };
  // Not byte for byte: each tells the second in which it was made.
  const auto timeless = [](Attributes attributes) {
    json provenance = json::parse(attributes.at("pellucid.provenance"));
    EXPECT_EQ(provenance.erase("started_utc"), 1U);
    attributes.at("pellucid.provenance") = provenance.dump();
    return attributes;
  };
  const ImageFile pasted = read_image(folder_ / "clip.png"), shown = read_image(png_name());
  EXPECT_EQ(pasted.image.pixels, shown.image.pixels);
  EXPECT_EQ(timeless(pasted.attributes), timeless(shown.attributes));

  ViewerWindow again({(folder_ / "small.scene_sampling_hulls_001.exr").string()}, folder_);
  const json picture = again.wait_picture();
  const json recipe = json::parse(saved.attributes.at("pellucid.recipe"));
  EXPECT_EQ(picture.at("recipe").at("view"), recipe.at("view"));
  EXPECT_EQ(picture.at("recipe").at("parameters"), recipe.at("parameters"));
}

TEST_F(Window, KeepsNamedSetUps) {
  ViewerWindow window({fog_, "-t", "volume_slices", "-s", "slices=5", "--size", "32x24"}, folder_);
  window.wait_picture();
  window.keys("shift+Tab", 2);
  window.key("Right");
  window.wait_until("the open section", [&] { return window.shows("bookmark name"); });
  window.keys("Tab", 6);
  window.type("mist");
  window.keys("Tab", 1);
  window.key("Return");
  EXPECT_EQ(window.wait("kept", [](const json& e) { return e.at("event") == "bookmark"; }).at("name"), "mist");
  window.screenshot("bookmarks.png");
  const auto kept = [&] { return read_file(folder_ / "config" / "pellucid" / "bookmarks.json"); };
  EXPECT_NE(kept().find("mist"), std::string::npos);
  window.key("Tab");
  window.key("Return");
  window.wait("removed", [](const json& e) { return e.at("event") == "bookmark removed"; });
  EXPECT_EQ(kept().find("mist"), std::string::npos);
}

TEST_F(Window, RendersNumberedFramesAlongAWay) {
  ViewerWindow window({fog_, "-t", "volume_slices", "--view", "front", "--size", "32x24"}, folder_);
  window.wait_picture();
  window.key("y");
  window.key("v");
  window.wait_picture([](const json& recipe) { return recipe.at("view") == "side"; });
  window.key("y");
  window.wait_status({"has 2 stops"});
  // The last section, by the keyboard alone.
  window.key("shift+Tab");
  window.key("Right");
  window.wait_until("the open section", [&] { return window.shows("frames"); });
  window.key("Tab");
  window.type("4:2");
  window.key("Return");
  window.key("ctrl+a");
  window.type("4:6");
  window.key("Return");
  window.screenshot("frames.png");
  window.keys("Tab", 4);
  window.key("Return");
  const json begun = window.wait("frames", [](const json& e) { return e.at("event") == "frames"; });
  window.wait("the last frame", [](const json& e) {
    return e.at("event") == "frames done" && e.at("done") == 3 && !e.at("running").get<bool>();
  });
  const std::filesystem::path frames = begun.at("folder").get<std::string>();
  EXPECT_EQ(frames.parent_path(), folder_.path());
  for (const auto& [frame, view] : {std::pair{"frame.0004.exr", "front"}, {"frame.0006.exr", "side"}}) {
    const std::string still = (folder_ / "still.exr").string();
    ASSERT_TRUE(
        succeeded(pellucid({"render", fog_, "-t", "volume_slices", "--size", "32x24", "--view", view, "-o", still})));
    EXPECT_EQ(read_image(frames / frame).image.pixels, read_image(still).image.pixels) << view;
  }
}

TEST_F(Window, FollowsTheMonitorsScale) {
  std::string why;
  const std::map<std::string, std::string> display{{"DISPLAY", XServer::get(why)->display()}};
  const Outcome set =
      run({"xprop", "-root", "-f", "RESOURCE_MANAGER", "8s", "-set", "RESOURCE_MANAGER", "Xft.dpi:\t144\n"},
          {.environment = display});
  if (set.status != 0) GTEST_SKIP() << "xprop: " << set.err;
  const auto panel_of = [&](const char* scale) {
    ViewerWindow window({fog_, "-t", "volume_slices", "--size", "48x36", "--ui-scale", scale}, folder_);
    return window.wait("a drawing", [](const json& e) { return e.at("event") == "drawn"; })
        .at("region")
        .at(0)
        .get<int>();
  };
  const int from_monitor = panel_of("monitor"), overridden = panel_of("1.25");
  run({"xprop", "-root", "-remove", "RESOURCE_MANAGER"}, {.environment = display});
  EXPECT_EQ(from_monitor, 348 * 144 / 96);
  EXPECT_EQ(overridden, 348 * 5 / 4);
}

TEST_F(Window, DrawsThePanelBesideNoSlowFrame) {
  ViewerWindow window({fog_, "-t", "volume_slices", "--size", "480x360"}, folder_);
  window.wait_picture();
  window.tab_to("slices");
  // More and more slices, until this machine takes longer for a frame than the panel waits at least, 0.08 s.
  constexpr double kSlow_ms = 120;
  int slow = 0;
  for (int slices = 16; slices <= 4096 && slow < 8; slices *= 2) {
    window.key("ctrl+a");
    window.type(std::to_string(slices));
    window.key("Return");
    window.wait_picture([&](const json& recipe) { return ViewerWindow::value(recipe, "slices") == slices; });
    for (int i = 0; i < 3; ++i) {
      window.wait("the panel", [](const json& e) { return is(e, "panel") && !e.at("busy"); });
      const std::size_t from = window.events().size();
      window.key("F5");
      const json picture = window.wait_picture();
      const auto& all = window.events();
      const auto begin = all.begin() + static_cast<std::ptrdiff_t>(from), end = std::find(begin, all.end(), picture);
      if (picture.at("frame_ms") < kSlow_ms) continue;
      ++slow;
      // Once is enough: where others use the machine, a frame may take much longer than the last and see a panel.
      if (std::none_of(begin, end, [](const json& e) { return is(e, "panel") && e.at("busy"); })) return;
    }
  }
  EXPECT_EQ(slow, 0) << "the panel is drawn beside each slow frame";
}

TEST_F(Window, TellsThePrecomputationsShareAndCancelsIt) {
  ViewerWindow window({glass_, "-t", "geocube", "-s", "resolution=32", "--size", "48x36"}, folder_,
                      {{"PELLUCID_CACHE", "off"}});
  const json before = window.wait_picture();
  window.tab_to("resolution");
  window.key("End");
  window.wait_status({"precomputing", " %", "Esc cancels"});
  window.key("Escape");
  window.wait_status({"cancelled"});
  // The state is the last picture's again, and it is what the next one shows.
  window.key("F5");
  EXPECT_EQ(window.wait_picture().at("recipe"), before.at("recipe"));
}

TEST(NoDisplay, IsToldWithTheCommandThatDoesTheSame) {
  TemporaryFolder folder;
  const std::string scene = write_small_scene(folder).string();
  const Outcome outcome = pellucid({"view", scene, "-t", "volume_slices", "-s", "slices=9"},
                                   {.environment = {{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}}});
  EXPECT_TRUE(refused(outcome, 1, {"there is no display", "pellucid render", "-t volume_slices", "slices=9"}));
}

}  // namespace
}  // namespace pellucid::test
