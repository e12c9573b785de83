// pellucid render --maps.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "algorithms/scene/images/image.hpp"
#include "tests/sandbox/program.hpp"

namespace pellucid::test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

class RenderMaps : public testing::Test {
 protected:
  TemporaryFolder folder;

  Outcome render(const std::string& scene, const std::string& technique, const Words& more) const {
    Words words{"render", scene, "-t", technique, "--size", "96x72", "-o", (folder / "out.exr").string()};
    words.insert(words.end(), more.begin(), more.end());
    return pellucid(words);
  }
};

TEST_F(RenderMaps, WriteTheValuesBehindTheStatistics) {
  const auto maps = folder / "deep/maps";
  const Outcome outcome = render("glass_ellipsoid", "geocube",
                                 {"-s", "placement=hand", "-s", "iterations=3", "--maps", maps.string(), "--json"});
  ASSERT_TRUE(succeeded(outcome));
  const json done = json::parse(outcome.out);
  ASSERT_EQ(done.at("maps").size(), 6U);
  for (const auto& [name, map] : done.at("maps").items()) {
    EXPECT_EQ(map.at("exr"), (maps / (name + ".exr")).string());
    const ImageFile file = read_image(map.at("exr").get<std::string>());
    ASSERT_EQ(file.image.width, 96) << name;
    ASSERT_EQ(file.image.height, 72) << name;
    ASSERT_EQ(file.image.channels, 1) << name;
    EXPECT_EQ(json::parse(file.attributes.at("pellucid.map")).at("name"), name);
    double sum = 0;
    int count = 0;
    for (const float v : file.image.pixels) {
      if (!std::isfinite(v)) continue;
      sum += static_cast<double>(v);
      ++count;
    }
    ASSERT_GT(count, 100) << name;
    const std::string statistic = name + (map.at("unit") == "" ? "_share" : "_mean");
    EXPECT_NEAR(done.at("native_errors").at(statistic).get<double>(), sum / count, 1e-12) << name;
    EXPECT_GT(map.at("range").get<double>(), 0) << name;
    const ImageFile png = read_image(map.at("png").get<std::string>());
    EXPECT_EQ(png.image.width, 96) << name;
    EXPECT_EQ(png.image.height, 72) << name;
  }
}

TEST_F(RenderMaps, SayWhatTheirColoursMean) {
  const auto maps = folder / "maps";
  const Outcome outcome = render("glass_ellipsoid", "geocube", {"-s", "placement=hand", "--maps", maps.string()});
  ASSERT_TRUE(succeeded(outcome));
  EXPECT_EQ(outcome.out, "");
  for (const char* words : {"exit_error.png", "[diagonals]", "pale yellow", "grey without a value"})
    EXPECT_NE(outcome.err.find(words), std::string::npos) << words << " in " << outcome.err;
}

TEST_F(RenderMaps, AreRefusedWhereThereAreNone) {
  const auto maps = folder / "maps";
  EXPECT_TRUE(refused(render("glass_ellipsoid", "front_refraction", {"--maps", maps.string()}), 2,
                      {"--maps", "front_refraction", "geocube"}));
  EXPECT_FALSE(std::filesystem::exists(maps));
  EXPECT_FALSE(std::filesystem::exists(folder / "out.exr"));
  write_file(folder / "taken", "no folder");
  EXPECT_TRUE(refused(render("glass_ellipsoid", "geocube", {"--maps", (folder / "taken").string()}), 1, {"taken"}));
  EXPECT_TRUE(
      refused(render("glass_ellipsoid", "geocube", {"--maps", (folder / "taken/below").string()}), 1, {"taken"}));
  const auto scene =
      write_file(folder / "empty.toml", "title = \"nothing\"\n[views.front]\neye = [0, 0, 3]\ntarget = [0, 0, 0]\n");
  EXPECT_TRUE(refused(render(scene.string(), "geocube", {"--maps", maps.string()}), 2, {"--maps", "no pixel"}));
}

TEST_F(RenderMaps, AreNoPicturesThatCanBeMadeAgain) {
  const auto maps = folder / "maps";
  ASSERT_TRUE(succeeded(render("glass_ellipsoid", "geocube", {"-s", "placement=hand", "--maps", maps.string()})));
  EXPECT_TRUE(refused(pellucid({"reproduce", (maps / "steps.exr").string(), "-o", (folder / "again").string()}), 2,
                      {"steps.exr", "neither render nor reference"}));
}

}  // namespace
}  // namespace pellucid::test
