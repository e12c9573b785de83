// Failures that the window tells and outlives.
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tests/viewer/window.hpp"

namespace pellucid::test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

class Failing : public testing::Test {
 protected:
  void SetUp() override {
    std::string why;
    if (XServer::get(why) == nullptr) GTEST_SKIP() << why;
  }
  TemporaryFolder folder_;
  std::string fog_ = write_small_scene(folder_).string();
};

/// A file system of 256 KB, which only root may mount.
class SmallDisk {
 public:
  explicit SmallDisk(fs::path path) : path_(std::move(path)) {
    fs::create_directory(path_);
    tried_ = run({"mount", "-t", "tmpfs", "-o", "size=256k", "tmpfs", path_.string()});
    if (mounted()) fs::create_directory(path_ / "pellucid");
  }
  ~SmallDisk() {
    if (mounted()) run({"umount", "-l", path_.string()});
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  bool mounted() const { return tried_.status == 0; }
  const std::string& why() const { return tried_.err; }
  const fs::path& path() const { return path_; }
  void fill() const {
    std::ofstream file(path_ / "filler", std::ios::binary);
    const std::string block(4096, ' ');
    while (file << block << std::flush) {
    }
  }

 private:
  fs::path path_;
  Outcome tried_;
};

int renderer_of(ViewerWindow& window) {
  const Outcome children = run({"pgrep", "-P", std::to_string(window.pid()), "-f", "view-renderer"});
  return children.status == 0 ? std::stoi(children.out) : 0;
}

TEST_F(Failing, RenderersAndShadersAreToldAndF5GoesOn) {
  const std::string own = "algorithms/volume_slices/slice.frag.glsl";
  const std::string good = read_file(fs::path(PELLUCID_SOURCE_DIR) / own);
  folder_.write("tree/" + own, good);
  ViewerWindow window(
      {fog_, "-t", "volume_slices", "-s", "slices=9", "--size", "48x36", "--shaders", (folder_ / "tree").string()},
      folder_);
  const json before = window.wait_picture();

  // A renderer that dies while it has nothing to do.
  const int renderer = renderer_of(window);
  ASSERT_GT(renderer, 0);
  ::kill(renderer, SIGABRT);  // AddressSanitizer keeps SIGSEGV for itself
  window.wait_status({"the renderer", "Aborted", "F5"});
  window.key("F5");
  const json after = window.wait_picture();
  EXPECT_EQ(after.at("recipe"), before.at("recipe"));
  EXPECT_NE(renderer_of(window), renderer);

  // A shader that does not compile: the last good one goes on.
  write_file(folder_ / "tree" / own, good + "\nbroken line here;\n");
  window.wait_status({"the last good shaders go on", own});
  window.screenshot("shader_error.png");
  window.key("F5");
  window.wait_picture();
  // One that compiles and makes GL errors, since a uniform has another type than the program sets.
  std::string mistyped = good;
  const std::string uniform = "uniform float slab_m;";
  ASSERT_NE(mistyped.find(uniform), std::string::npos);
  mistyped.replace(mistyped.find(uniform), uniform.size(), "uniform int slab_m;");
  write_file(folder_ / "tree" / own, mistyped);
  window.wait_status({"set uniform 'slab_m'"});
  EXPECT_TRUE(window.running());

  write_file(folder_ / "tree" / own, good);
  const json mended = window.wait_picture();
  EXPECT_EQ(mended.at("recipe"), before.at("recipe"));
  window.wait("no more trouble", [&](const json& e) {
    return is(e, "status") && e.at("words").get<std::string>().find("shaders") == std::string::npos &&
           e.at("words").get<std::string>().find("slab_m") == std::string::npos;
  });
}

TEST_F(Failing, ARenderersWarningIsToldOnce) {
  // A room without a sky, seen by a technique that shows the environment alone: its glass is black.
  ViewerWindow window({"glass_room", "-t", "front_refraction", "--size", "48x36"}, folder_);
  window.wait_status({"warning: front_refraction shows the environment alone"});
  window.screenshot("warning.png");
  window.key("F5");
  window.wait_picture();
  // Another renderer warns again; the window has told it.
  ::kill(renderer_of(window), SIGABRT);
  // F5 before the window knows of its end would ask the dying one.
  window.wait_status({"the renderer", "Aborted"});
  window.key("F5");
  window.wait_picture();
  const auto& all = window.events();
  EXPECT_EQ(std::count_if(all.begin(), all.end(), [](const json& e) { return is(e, "told"); }), 1);
}

TEST_F(Failing, AScenesWarningsAreTold) {
  folder_.write("part.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 0\nvn 0 0 1\nf 1//1 2//2 3//2\n");
  const std::string part =
      "[meshes.part]\nfile = \"part.obj\"\n[instances.part]\nmesh = \"part\"\nmaterial = \"grey\"\n";
  const std::string scene = folder_.write("part.scene.toml", read_file(fog_) + "\n" + part).string();
  ViewerWindow window({scene, "-t", "volume_slices", "--size", "32x24"}, folder_);
  window.wait_status({"warning: ", "part.scene.toml", "have no normals"});
}

TEST_F(Failing, ALostContextIsToldInAnotherWindowWithTheSameState) {
  ViewerWindow window({fog_, "-t", "sampling_hulls", "-s", "hulls=3", "--size", "48x36", "--compare", "ray_marching",
                       "--lose-context-at", "3"},
                      folder_);
  window.wait_picture();
  window.key("F5");  // two sides: the fourth picture
  window.wait("another window", [](const json& e) { return is(e, "opened"); });
  window.wait_status({"graphics context failed", "--lose-context-at"});
  window.find();
  window.screenshot("lost_context.png");
  window.tab_to("hulls");
  window.key("Right");
  const json picture_event = window.wait_picture();
  EXPECT_EQ(ViewerWindow::value(picture_event.at("recipe"), "hulls"), 4);
  window.wait_until("the other side", [&] {
    const auto& all = window.events();
    return std::any_of(all.begin(), all.end(), [&](const json& e) {
      return is(e, "picture") && e.at("side") == "b" && e.at("generation") >= picture_event.at("generation");
    });
  });
}

TEST_F(Failing, AFullDiskAndDamagedBookmarksLoseNothing) {
  const SmallDisk disk(folder_ / "disk");
  if (!disk.mounted()) GTEST_SKIP() << "no file system can be mounted here: " << disk.why();
  write_file(disk.path() / "pellucid" / "bookmarks.json", "not JSON");
  disk.fill();
  ViewerWindow window({fog_, "-t", "volume_slices", "--size", "48x36", "--folder", disk.path().string()}, folder_,
                      {{"XDG_CONFIG_HOME", disk.path().string()}});
  window.wait_status({"bookmarks.json", "parse error"});
  window.key("F5");
  const json before = window.wait_picture();
  const auto text = [&](const char* name) { return read_file(disk.path() / name); };

  window.key("ctrl+s");
  window.wait_status({"cannot write", "No space left"});
  window.key("ctrl+shift+s");
  window.wait_status({"cannot write", ".png", "No space left"});
  window.key("k");
  window.wait_status({"cannot write", "bookmarks.json"});
  window.tab_to("slices");
  window.key("x");
  window.wait_status({"cannot write", ".toml"});
  window.key("Escape");
  EXPECT_EQ(text("pellucid/bookmarks.json"), "not JSON");
  for (const auto& entry : fs::directory_iterator(disk.path()))
    EXPECT_TRUE(entry.path().filename() == "filler" || entry.is_directory()) << entry.path() << " was left behind";

  fs::remove(disk.path() / "filler");
  window.key("ctrl+s");
  window.wait("saved", [](const json& e) { return is(e, "saved"); });
  const ImageFile saved = read_image(disk.path() / "small.scene_volume_slices_001.exr");
  EXPECT_EQ(json::parse(saved.attributes.at("pellucid.recipe")), before.at("recipe"));
  window.key("k");
  window.wait("kept", [](const json& e) { return is(e, "bookmark"); });
  EXPECT_EQ(text("pellucid/bookmarks.json.damaged_1"), "not JSON");
  EXPECT_NE(text("pellucid/bookmarks.json").find("volume_slices"), std::string::npos);
}

}  // namespace
}  // namespace pellucid::test
