// pellucid reproduce: a picture from what its file says of itself; which papers there are.
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "algorithms/scene/images/image.hpp"
#include "tests/sandbox/program.hpp"

namespace pellucid::test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

class ReproduceAgain : public testing::Test {
 protected:
  TemporaryFolder folder;
  std::string scene = write_small_scene(folder).string();
  std::filesystem::path picture = folder / "fog.exr";

  void render(const Words& more = {}) {
    Words words{"render", scene, "-t", "sampling_hulls", "--size", "64x48", "-o", picture.string()};
    words.insert(words.end(), more.begin(), more.end());
    ASSERT_TRUE(succeeded(pellucid(words)));
  }
  Outcome reproduce(const Words& more = {}) {
    Words words{"reproduce", picture.string(), "-o", (folder / "again").string()};
    words.insert(words.end(), more.begin(), more.end());
    return pellucid(words);
  }
  json facts(const Words& more = {}, int status = 0) {
    Words words{"--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = reproduce(words);
    EXPECT_EQ(outcome.status, status) << outcome.err;
    return json::parse(outcome.out);
  }
  // Writes the picture anew after `change` has altered it.
  void alter(const std::function<void(ImageFile&)>& change) const {
    ImageFile file = read_image(picture);
    change(file);
    write_exr(picture, file, ExrPixel::single);  // which holds what was read
  }
  void alter_json(const char* attribute, const std::function<void(json&)>& change) const {
    alter([&](ImageFile& file) {
      json value = json::parse(file.attributes.at(attribute));
      change(value);
      file.attributes[attribute] = value.dump();
    });
  }
};

TEST_F(ReproduceAgain, ARenderingIsBitIdentical) {
  render({"-s", "hulls=3", "-s", "samples=5", "-s", "sample_offset=0.3", "-s", "scene.density=1.7", "-s",
          "frame.format=single", "--view", "side"});
  const json done = facts();
  EXPECT_EQ(done.at("verdict"), "identical");
  EXPECT_TRUE(done.at("bit_identical").get<bool>());
  EXPECT_EQ(done.at("max_abs_difference"), 0.0);
  EXPECT_TRUE(done.at("same_device_driver_commit").get<bool>());
  const ImageFile before = read_image(picture), after = read_image(folder / "again" / "fog.exr");
  EXPECT_EQ(before.image.pixels, after.image.pixels);
  EXPECT_EQ(json::parse(before.attributes.at("pellucid.recipe")), json::parse(after.attributes.at("pellucid.recipe")));
  const Outcome told = reproduce();
  EXPECT_TRUE(succeeded(told));
  EXPECT_NE(told.out.find("bit-identical"), std::string::npos) << told.out;
}

TEST_F(ReproduceAgain, AReferenceIsBitIdenticalAndItsMaskToo) {
  ASSERT_TRUE(succeeded(pellucid({"reference", scene, "--size", "48x36", "-s", "scene.density=2", "--surfaces",
                                  "raster", "--tolerance", "1e-3", "-o", picture.string()})));
  EXPECT_EQ(facts().at("verdict"), "identical");
  alter([](ImageFile& file) { file.layers.at("mask").pixels.at(7) += 0.5F; });
  const json done = facts({}, 3);
  EXPECT_EQ(done.at("different_pixels"), 1);
  EXPECT_NEAR(done.at("max_abs_difference").get<double>(), 0.5, 1e-3);
}

TEST_F(ReproduceAgain, ADifferenceBeyondTheToleranceIsARegression) {
  render();
  alter([](ImageFile& file) { file.image.at(5, 7)[1] += 0.25F; });
  const json done = facts({}, 3);
  EXPECT_EQ(done.at("verdict"), "differs");
  EXPECT_EQ(done.at("different_pixels"), 1);
  EXPECT_NEAR(done.at("max_abs_difference").get<double>(), 0.25, 1e-3);
  EXPECT_EQ(facts({"--tolerance", "0.5"}).at("verdict"), "within tolerance");
  const Outcome told = reproduce();
  EXPECT_EQ(told.status, 3);
  EXPECT_NE(told.out.find("(5, 7)"), std::string::npos) << told.out;
}

TEST_F(ReproduceAgain, AnotherCommitOrDeviceIsToldAndNotJudged) {
  render();
  alter([](ImageFile& file) { file.image.at(5, 7)[1] += 0.25F; });
  alter_json("pellucid.provenance", [](json& origin) {
    origin["commit"] = "0123456789abcdef";
    origin["device"] = "another device";
    origin["scene_hash"] = "00";
  });
  const json done = facts();
  EXPECT_EQ(done.at("verdict"), "not judged");
  const std::string changes = done.at("changes").dump();
  for (const char* what : {"0123456789abcdef", "another device", "scene_hash"})
    EXPECT_NE(changes.find(what), std::string::npos) << changes;
}

TEST_F(ReproduceAgain, AChangedSceneIsNoticed) {
  render();
  write_file(scene, read_file(scene) + "\n# one line more\n");
  const json done = facts();
  EXPECT_EQ(done.at("verdict"), "identical");
  EXPECT_NE(done.at("changes").dump().find("scene_hash"), std::string::npos) << done.at("changes");
}

// ---- what is refused ----

TEST_F(ReproduceAgain, AFileThatDoesNotSayHowItWasMade) {
  render();
  for (const char* attribute : {"pellucid.recipe", "pellucid.provenance", "pellucid.command"}) {
    const std::string before = read_file(picture);
    alter([&](ImageFile& file) { file.attributes.erase(attribute); });
    EXPECT_TRUE(refused(reproduce(), 2, {"fog.exr", attribute}));
    write_file(picture, before);
  }
  alter([](ImageFile& file) { file.attributes["pellucid.recipe"] = "{ half a rec"; });
  EXPECT_TRUE(refused(reproduce(), 2, {"fog.exr", "pellucid.recipe"}));
}

TEST_F(ReproduceAgain, ARecipeThatCannotBeMade) {
  render();
  const std::string before = read_file(picture);
  const auto refused_with = [&](const std::function<void(json&)>& change, const Words& parts) {
    alter_json("pellucid.recipe", change);
    const auto result = refused(reproduce(), 2, parts);
    write_file(picture, before);
    return result;
  };
  EXPECT_TRUE(refused_with([](json& r) { r.erase("technique"); }, {"fog.exr", "pellucid.recipe"}));
  EXPECT_TRUE(refused_with([](json& r) { r["width"] = "wide"; }, {"fog.exr", "pellucid.recipe"}));
  EXPECT_TRUE(refused_with([](json& r) { r["width"] = 100000; }, {"fog.exr", "100000"}));
  EXPECT_TRUE(refused_with([](json& r) { r["technique"] = "sampling_hull"; }, {"fog.exr", "'sampling_hulls'"}));
  EXPECT_TRUE(refused_with([](json& r) { r["parameters"]["hulls"] = 65; }, {"fog.exr", "hulls", "[1, 64]"}));
  EXPECT_TRUE(refused_with([](json& r) { r["scene"] = "gone.toml"; }, {"fog.exr", "gone.toml"}));
  // A file's words are never options of the program.
  EXPECT_TRUE(refused_with([](json& r) { r["scene"] = "--help"; }, {"fog.exr", "--help"}));
}

TEST_F(ReproduceAgain, APictureIsNotOverwrittenByItsOwnCopy) {
  render();
  const std::string before = read_file(picture);
  EXPECT_TRUE(refused(pellucid({"reproduce", picture.string(), "-o", folder.path().string()}), 2, {"overwrite"}));
  EXPECT_EQ(read_file(picture), before);
}

TEST_F(ReproduceAgain, AFileThatIsMissingDamagedOrOfAnotherKind) {
  EXPECT_TRUE(refused(reproduce(), 2, {"fog.exr"}));
  write_file(picture, "no image");
  EXPECT_TRUE(refused(reproduce(), 2, {"fog.exr"}));
  picture = folder / "fog.png";
  render();
  EXPECT_TRUE(refused(reproduce(), 2, {"fog.png", "EXR"}));
}

TEST_F(ReproduceAgain, AnUnknownPaperWithTheNearest) {
  const std::string out = (folder / "results").string();
  EXPECT_TRUE(refused(pellucid({"reproduce", "samplng_hulls", "-o", out}), 2, {"'samplng_hulls'", "'sampling_hulls'"}));
  EXPECT_TRUE(refused(pellucid({"reproduce", "al", "-o", out}), 2, {"'all'"}));
  EXPECT_TRUE(refused(pellucid({"reproduce", "qqqqqqqq", "-o", out}), 2, {"qqqqqqqq", "sampling_hulls", "all"}));
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(ReproduceAgain, OptionsThatDoNotGoTogether) {
  render();
  EXPECT_TRUE(refused(reproduce({"--preview"}), 2, {"--preview"}));
  EXPECT_TRUE(refused(reproduce({"--tolerance", "-1"}), 2, {"--tolerance"}));
  EXPECT_TRUE(
      refused(pellucid({"reproduce", "sampling_hulls", "--tolerance", "1", "-o", (folder / "results").string()}), 2,
              {"--tolerance"}));
  EXPECT_TRUE(refused(pellucid({"reproduce", "sampling_hulls"}), 2, {"--output"}));
}

TEST_F(ReproduceAgain, AFolderThatCannotBeMade) {
  render();
  const auto file = write_file(folder / "file", "not a folder");
  EXPECT_TRUE(
      refused(pellucid({"reproduce", picture.string(), "-o", (file / "results").string()}), 1, {"file/results"}));
  EXPECT_TRUE(
      refused(pellucid({"reproduce", "all", "--preview", "-o", (file / "results").string()}), 1, {"file/results"}));
}

TEST_F(ReproduceAgain, EveryPaperThatIsListedIsKnown) {
  const Outcome listed = pellucid({"list", "papers", "--json"});
  ASSERT_TRUE(succeeded(listed));
  const json papers = json::parse(listed.out);
  ASSERT_FALSE(papers.empty());
  const auto file = write_file(folder / "file", "not a folder");
  for (const json& paper : papers) {
    EXPECT_TRUE(refused(pellucid({"reproduce", paper.at("name").get<std::string>(), "-o", (file / "x").string()}), 1,
                        {"file/x"}));
  }
}

}  // namespace
}  // namespace pellucid::test
