// pellucid reference, of mirrors and glass.
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "algorithms/scene/images/image.hpp"
#include "tests/glass_ball.hpp"
#include "tests/sandbox/program.hpp"

namespace pellucid {
namespace {

using nlohmann::json;
using test::kGlassBall;
using test::pellucid;

class GlassReference : public testing::Test {
 protected:
  void SetUp() override { std::ofstream(folder / "glass.toml") << kGlassBall; }
  test::Outcome trace(std::vector<std::string> more, const std::string& out = "out.exr") {
    std::vector<std::string> all{"reference", (folder / "glass.toml").string(), "--size", "48x36",
                                 "-o",        (folder / out).string()};
    all.insert(all.end(), more.begin(), more.end());
    return pellucid(all);
  }
  test::TemporaryFolder folder;
};

TEST_F(GlassReference, StatesCostAndErrors) {
  const test::Outcome outcome = trace({"--json"});
  ASSERT_TRUE(succeeded(outcome));
  const json said = json::parse(outcome.out);
  EXPECT_EQ(said.at("samples"), 1);
  EXPECT_EQ(said.at("standard_error_max"), 0.0);
  EXPECT_GT(said.at("trace_s"), 0.0);
  EXPECT_GT(said.at("rays"), 48 * 36);
  EXPECT_GT(said.at("rays_per_s"), 0.0);
  EXPECT_LT(said.at("cut_weight_max"), 0.05);
  EXPECT_EQ(said.at("lost_weight_mean"), 0.0);
  const ImageFile file = read_image(folder / "out.exr");
  double masked = 0;
  for (const float m : file.layers.at("mask").pixels)
    masked += m > 0.5F ? 1 : 0;
  EXPECT_GT(masked, 50) << "the ball";
  EXPECT_LT(masked, 48 * 36 / 3);
}

TEST_F(GlassReference, SamplesCausticsAndParametersAreCarriedAndMadeAgain) {
  ASSERT_TRUE(succeeded(trace({})));
  const test::Outcome outcome = trace(
      {"--samples", "4", "--caustics", "--photons", "20000", "--reflections", "2", "-s", "scene.eta=1.3", "--json"},
      "full.exr");
  ASSERT_TRUE(succeeded(outcome));
  const json said = json::parse(outcome.out);
  EXPECT_GT(said.at("standard_error_max"), 0.0);
  EXPECT_GT(said.at("caustic_standard_error_max"), 0.0);
  EXPECT_GT(said.at("limited_weight_mean"), 0.0);
  EXPECT_NE(read_image(folder / "full.exr").image.pixels, read_image(folder / "out.exr").image.pixels);
  const test::Outcome again =
      pellucid({"reproduce", (folder / "full.exr").string(), "-o", (folder / "again").string()});
  ASSERT_TRUE(succeeded(again));
  EXPECT_NE((again.out + again.err).find("bit-identical"), std::string::npos) << again.out << again.err;
}

TEST_F(GlassReference, RefusesWhatCannotBe) {
  EXPECT_TRUE(refused(trace({"--surfaces", "raster"}), 2, {"glass", "mirrors", "rays"}));
  EXPECT_TRUE(refused(trace({"--method", "slices"}), 2, {"glass", "slices"}));
  for (const std::vector<std::string>& bad :
       {std::vector<std::string>{"--samples", "0"}, {"--reflections", "-1"}, {"--cut", "2"}, {"--photons", "3"}})
    EXPECT_TRUE(refused(trace(bad), 2, {bad[0]}));
  std::string fog = kGlassBall;
  fog += "[volume]\nkind = \"constant\"\nvoxels = 4\nmin = [-1, 0, -1]\nmax = [1, 1, 1]\nextinction = 1\n";
  std::ofstream(folder / "glass.toml") << fog;
  EXPECT_TRUE(refused(trace({}), 2, {"volume", "medium"}));
  const auto without = fog.find("kind = \"dielectric\"");
  fog.replace(without, 19, "kind = \"lambertian\"").replace(fog.find("[parameters]"), 13, "");
  fog.replace(fog.find("eta ="), fog.find("\n", fog.find("eta =")) - fog.find("eta ="), "");
  std::ofstream(folder / "glass.toml") << fog;
  EXPECT_TRUE(succeeded(trace({})));
  EXPECT_TRUE(refused(trace({"--samples", "4"}), 2, {"4 samples", "medium"}));
  std::ofstream(folder / "glass.toml") << kGlassBall;
}

TEST_F(GlassReference, WarnsOfAnOpenSolid) {
  std::string open = kGlassBall;
  open.replace(open.find("shape = \"sphere\"\nradius = 0.5"), 29, "shape = \"plane\"\nsize = [3, 3]");
  open.replace(open.find("size = [6, 6]"), 13, "size = [0.1, 0.1]");
  std::ofstream(folder / "glass.toml") << open;
  const test::Outcome outcome = trace({});
  ASSERT_TRUE(succeeded(outcome));
  EXPECT_NE(outcome.err.find("warning:"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("open"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace pellucid
