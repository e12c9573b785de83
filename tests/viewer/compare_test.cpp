#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "sweeps/store/store.hpp"
#include "tests/viewer/window.hpp"

namespace pellucid::test {
namespace {

using nlohmann::json;

class Comparing : public testing::Test {
 protected:
  void SetUp() override {
    std::string why;
    if (XServer::get(why) == nullptr) GTEST_SKIP() << why;
  }
  TemporaryFolder folder_;
  std::string fog_ = write_small_scene(folder_).string();
};

TEST_F(Comparing, ShowsATechniqueAFileAndTheReferenceAsItConverges) {
  for (const auto& [technique, file] : {std::pair{"volume_slices", "a.exr"}, {"ray_marching", "b.exr"}}) {
    ASSERT_TRUE(
        succeeded(pellucid({"render", fog_, "-t", technique, "--size", "96x72", "-o", (folder_ / file).string()})));
  }
  const Outcome truth = pellucid({"compare", (folder_ / "b.exr").string(), (folder_ / "a.exr").string(), "--json"});
  ASSERT_TRUE(succeeded(truth));
  const double flip = json::parse(truth.out).at("flip_mean");
  ViewerWindow window({fog_, "-t", "volume_slices", "--size", "96x72", "--compare", "ray_marching"}, folder_);
  window.wait("picture of B", [](const json& e) { return is(e, "picture") && e.at("side") == "b"; });
  window.key("l");
  const json found = window.wait("FLIP", [](const json& e) { return is(e, "flip"); });
  EXPECT_NEAR(found.at("flip_mean"), flip, 2e-4);  // the files hold halves, the window floats
  EXPECT_GT(flip, 0);
  window.key("l");

  // Two views next to each other, at one camera: half as wide each.
  const auto is_mode = [](const char* mode) {
    return [mode](const json& e) { return is(e, "drawn") && e.at("mode") == mode; };
  };
  window.key("m");
  window.wait("blinking", is_mode("blink"));
  for (const char* mode : {"difference", "A alone", "B alone", "side by side"}) {
    window.key("m");
    window.wait(mode, is_mode(mode));
  }
  const Image screen = window.screenshot("side_by_side.png");
  EXPECT_EQ(screen.width, 900);

  // A file, which is read again when it changes: the other picture takes its place as an editor would do it.
  window.click("compare file");
  window.type((folder_ / "a.exr").string());
  window.key("Return");
  window.wait("the file",
              [](const json& e) { return is(e, "second") && e.at("words").get<std::string>().ends_with("a.exr"); });
  window.key("l");
  const json same = window.wait("FLIP of the file", [](const json& e) { return is(e, "flip"); });
  EXPECT_LT(same.at("flip_mean"), 2e-3);  // of itself, rounded to halves
  std::filesystem::copy_file(folder_ / "b.exr", folder_ / "new.exr");
  std::filesystem::rename(folder_ / "new.exr", folder_ / "a.exr");
  const json other = window.wait("FLIP of the new file", [](const json& e) { return is(e, "flip"); });
  EXPECT_NEAR(other.at("flip_mean"), flip, 2e-4);

  window.click("compare with");
  window.wait("the list", [](const json& e) { return is(e, "places") && e.at("widgets").contains("list"); });
  window.type("refer");
  window.key("Return");
  // It comes at a quarter of the size first, which a fast machine may pass by between two drawings.
  window.wait("the full reference", [](const json& e) {
    return is(e, "second") && e.at("width") == 96 && e.at("words").get<std::string>().starts_with("reference: 96x72");
  });
}

TEST_F(Comparing, SweepsAParameterHereIntoAnOrdinaryStore) {
  ViewerWindow window({fog_, "-t", "volume_slices", "--size", "48x36"}, folder_);
  window.wait_picture();
  window.tab_to("slices");
  window.key("x");
  const json sweep = window.wait("sweep", [](const json& e) { return is(e, "sweep"); });
  window.wait("all rows", [](const json& e) { return is(e, "sweep rows") && !e.at("running").get<bool>(); });
  const auto rows = sweeps::read_rows(sweep.at("store").get<std::string>());
  EXPECT_GE(rows.size(), 5U);
  for (const json& row : rows)
    EXPECT_EQ(row.at("status"), "ok") << row.dump();
  window.screenshot("sweep.png");

  // Another one, in whose midst the window is killed: the store is whole, and no process is left behind.
  window.key("x");
  const json killed = window.wait("sweep", [](const json& e) { return is(e, "sweep"); });
  window.wait("a row", [](const json& e) { return is(e, "sweep rows") && e.at("rows") > 0; });
  ::kill(window.pid(), SIGKILL);
  const std::string spec = killed.at("spec"), store = killed.at("store");
  // The renderer and the sweep die with it; the sweep's own worker when it notices.
  bool left = true;
  for (int i = 0; i < 100 && left; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    left = run({"pgrep", "-f", spec}).status == 0;
  }
  EXPECT_FALSE(left);
  EXPECT_GE(sweeps::read_rows(store).size(), 1U);
}

// A minute; PELLUCID_TWEAK_SECONDS=1800 is the long run.
TEST_F(Comparing, SurvivesRandomTweaking) {
  const char* given = std::getenv("PELLUCID_TWEAK_SECONDS");
  const std::string seconds = given != nullptr ? given : "60";
  // Small scenes and pictures: the point is the number of changes, not their cost.
  ViewerWindow window({fog_, "-t", "volume_slices", "--size", "48x36", "--random-tweaks", "7", "--seconds", seconds},
                      folder_);
  const double patience_s = std::stod(seconds) + 100;  // the last state is drawn again
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(patience_s);
  while (window.running() && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  ASSERT_FALSE(window.running()) << "it does not come to its end";
  const json report = window.wait("the report", [](const json& e) { return is(e, "tweaks"); });
  EXPECT_TRUE(report.at("complete").get<bool>());
  // Pictures of another state, failed renderers, objects, files and processes left behind.
  EXPECT_EQ(report.at("faults"), json::array()) << report.dump(2);
  EXPECT_GE(report.at("pictures"), 5);
}

}  // namespace
}  // namespace pellucid::test
