#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
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

std::size_t files_open(int pid) {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/fd"))
    ++count;
  return count;
}

bool is(const json& event, const char* name) {
  return event.at("event") == name;
}

TEST_F(Comparing, GivesTheFlipOfTheCommandLine) {
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
}

TEST_F(Comparing, ShowsTheReferenceAsItConverges) {
  ViewerWindow window({fog_, "-t", "volume_slices", "--size", "96x72", "--compare", "reference"}, folder_);
  window.wait_picture();
  window.wait("a reference", [](const json& e) { return is(e, "second") && e.at("width") == 24; });
  window.wait("the full reference", [](const json& e) { return is(e, "second") && e.at("width") == 96; });
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
}

TEST_F(Comparing, LeavesNoProcessBehindWhenItIsKilledInASweep) {
  ViewerWindow window({fog_, "-t", "volume_slices", "--size", "48x36"}, folder_);
  window.wait_picture();
  window.tab_to("slices");
  window.key("x");
  const json sweep = window.wait("sweep", [](const json& e) { return is(e, "sweep"); });
  window.wait("a row", [](const json& e) { return is(e, "sweep rows") && e.at("rows") > 0; });
  ::kill(window.pid(), SIGKILL);
  const std::string spec = sweep.at("spec");
  // The renderer and the sweep die with it; the sweep's own worker when it notices.
  bool left = true;
  for (int i = 0; i < 100 && left; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    left = run({"pgrep", "-f", spec}).status == 0;
  }
  EXPECT_FALSE(left);
  const std::string store = sweep.at("store");
  EXPECT_GE(sweeps::read_rows(store).size(), 1U);
}

TEST_F(Comparing, ReloadsAShaderAndKeepsTheLastGoodOne) {
  const std::string own = "algorithms/volume_slices/slice.frag.glsl";
  const std::string good = read_file(std::filesystem::path(PELLUCID_SOURCE_DIR) / own);
  folder_.write("tree/" + own, good);
  ViewerWindow window({fog_, "-t", "volume_slices", "--size", "48x36", "--shaders", (folder_ / "tree").string()},
                      folder_);
  const json first = window.wait_picture();
  write_file(folder_ / "tree" / own, good + "\nbroken line here;\n");
  window.wait("the error", [&](const json& e) {
    return is(e, "status") && e.at("words").get<std::string>().find(own) != std::string::npos;
  });
  window.screenshot("shader_error.png");
  write_file(folder_ / "tree" / own, good);
  window.wait("no error", [&](const json& e) {
    return is(e, "status") && e.at("words").get<std::string>().find("shaders") == std::string::npos;
  });
}

TEST_F(Comparing, SurvivesRandomTweaking) {
  // Small scenes and pictures: the point is the number of changes, not their cost.
  ViewerWindow window({fog_, "-t", "volume_slices", "--size", "48x36", "--random-tweaks", "7", "--seconds", "20"},
                      folder_);
  window.wait_picture();
  const std::size_t before = files_open(window.pid());
  std::size_t most = 0;
  while (window.running()) {
    std::this_thread::sleep_for(std::chrono::seconds(1));
    std::error_code gone;
    if (std::filesystem::exists("/proc/" + std::to_string(window.pid()) + "/fd", gone)) {
      try {
        most = std::max(most, files_open(window.pid()));
      } catch (const std::filesystem::filesystem_error&) {
        break;  // it has just closed
      }
    }
  }
  EXPECT_LE(most, before + 4);
  std::size_t pictures = 0;
  for (const json& event : window.events()) {
    pictures += is(event, "picture") ? 1 : 0;
    if (is(event, "tweaks")) {
      EXPECT_EQ(event.at("disagreements"), 0) << event.dump();
    }
    if (is(event, "status")) {
      EXPECT_EQ(event.at("words").get<std::string>().find("GL_"), std::string::npos) << event.dump();
    }
  }
  EXPECT_GT(pictures, 2U);
}

TEST_F(Comparing, TellsOfAnUnreadableBookmarkFileAndKeepsIt) {
  folder_.write("config/pellucid/bookmarks.json", "not JSON");
  ViewerWindow window({fog_, "-t", "volume_slices", "--size", "48x36"}, folder_);
  window.wait("the reason", [](const json& e) {
    return is(e, "status") && e.at("words").get<std::string>().find("bookmarks.json") != std::string::npos;
  });
  window.wait_picture();
  window.key("k");
  window.wait("kept", [](const json& e) { return is(e, "bookmark"); });
  EXPECT_EQ(read_file(folder_ / "config/pellucid/bookmarks.json.damaged_1"), "not JSON");
  EXPECT_NE(read_file(folder_ / "config/pellucid/bookmarks.json").find("volume_slices"), std::string::npos);
}

TEST_F(Comparing, IsIdleWhenNothingHappens) {
  ViewerWindow window({fog_, "-t", "volume_slices", "--size", "96x72"}, folder_);
  window.wait_picture();
  std::this_thread::sleep_for(std::chrono::seconds(2));
  const auto ticks = [&] {
    std::ifstream file("/proc/" + std::to_string(window.pid()) + "/stat");
    std::string word;
    long used = 0;
    for (int i = 1; i <= 15 && file >> word; ++i)
      if (i == 14 || i == 15) used += std::stol(word);
    return used;
  };
  const long before = ticks();
  std::this_thread::sleep_for(std::chrono::seconds(5));
  EXPECT_LE(ticks() - before, 10);  // 2 % of a core: 10 ticks of 10 ms in 5 s
}

}  // namespace
}  // namespace pellucid::test
