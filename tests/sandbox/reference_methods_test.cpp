// pellucid reference: the methods, the surfaces, the shadows' layer; what describe tells of a volume.
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

class ReferenceMethods : public testing::Test {
 protected:
  TemporaryFolder folder;
  std::string scene = write_small_scene(folder).string();
  std::filesystem::path picture = folder / "truth.exr";

  Outcome reference(const Words& more) {
    Words words{"reference", scene, "--size", "48x36", "--tolerance", "1e-3", "-o", picture.string()};
    words.insert(words.end(), more.begin(), more.end());
    return pellucid(words);
  }
  json facts(Words more) {
    more.emplace_back("--json");
    const Outcome outcome = reference(more);
    EXPECT_TRUE(succeeded(outcome));
    return json::parse(outcome.out);
  }
};

TEST_F(ReferenceMethods, SlicesTellHowFarTheyLieFromTheExactOne) {
  const json few = facts({"--method", "slices", "--slices", "4", "--format", "single"});
  const json many = facts({"--method", "slices", "--slices", "256", "--format", "single"});
  EXPECT_EQ(many.at("method"), "slices");
  EXPECT_EQ(many.at("slices"), 256);
  EXPECT_EQ(many.at("format"), "single");
  EXPECT_GT(many.at("to_exact_rmse"), 0.0);
  EXPECT_LT(many.at("to_exact_rmse"), few.at("to_exact_rmse"));
  EXPECT_LT(many.at("to_exact_flip_mean"), few.at("to_exact_flip_mean"));
  const Outcome told = reference({"--method", "slices", "--slices", "8"});
  EXPECT_NE(told.err.find("from the exact reference: FLIP"), std::string::npos) << told.err;
  // The file knows how it was made.
  const Outcome again = pellucid({"reproduce", picture.string(), "-o", (folder / "again").string(), "--json"});
  ASSERT_TRUE(succeeded(again));
  EXPECT_EQ(json::parse(again.out).at("verdict"), "identical");
}

TEST_F(ReferenceMethods, ShadowsHaveALayerOfTheirOwn) {
  facts({"--surfaces", "raster", "--shadow-share", "0.05"});
  const ImageFile file = read_image(picture);
  ASSERT_TRUE(file.layers.contains("shadow"));
  EXPECT_EQ(file.layers.at("shadow").width, 48);
  facts({"--surfaces", "raster"});
  EXPECT_FALSE(read_image(picture).layers.contains("shadow"));
}

TEST_F(ReferenceMethods, ShadowMapsCanBeSetWhereTheyAreDrawn) {
  EXPECT_EQ(facts({"--surfaces", "forward", "-s", "shadow.size=64"}).at("parameters").at("shadow.size"), 64);
  EXPECT_TRUE(refused(reference({"--surfaces", "rays", "-s", "shadow.size=64"}), 2, {"shadow.size"}));
  EXPECT_TRUE(refused(reference({"--surfaces", "forward", "-s", "hulls=4"}), 2, {"hulls", "shadow."}));
}

TEST_F(ReferenceMethods, RefusesWhatBelongsToTheOtherMethod) {
  EXPECT_TRUE(refused(reference({"--slices", "64"}), 2, {"--slices", "--method slices"}));
  EXPECT_TRUE(refused(reference({"--method", "exact", "--format", "single"}), 2, {"--format", "--method slices"}));
  EXPECT_TRUE(refused(reference({"--method", "slices", "--slices", "0"}), 2, {"--slices"}));
  EXPECT_TRUE(refused(reference({"--method", "guess"}), 2, {"--method"}));
}

TEST_F(ReferenceMethods, TellsTheVolume) {
  const json volume = facts({}).at("volume");
  EXPECT_EQ(volume.at("voxels"), (json{16, 16, 16}));
  EXPECT_EQ(volume.at("file_range"), nullptr) << "it is of no file";
  EXPECT_NEAR(volume.at("voxel_spacing_m").at(0).get<double>(), 3.0 / 16, 1e-6);
  const Outcome described = pellucid({"describe", scene, "--json"});
  ASSERT_TRUE(succeeded(described));
  EXPECT_EQ(json::parse(described.out).at("volume"), volume);
  EXPECT_NE(pellucid({"describe", scene}).out.find("volume: 16×16×16 voxels"), std::string::npos);
}

}  // namespace
}  // namespace pellucid::test
