// pellucid bench.
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/sandbox/program.hpp"

namespace pellucid::test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

class Bench : public testing::Test {
 protected:
  TemporaryFolder folder;
  std::string scene = write_small_scene(folder).string();

  Outcome bench(const Words& more = {}) const {
    Words words{"bench", "sampling_hulls", "--scene", scene, "--size", "64x48", "--frames", "8"};
    words.insert(words.end(), more.begin(), more.end());
    return pellucid(words);
  }
  json measured(Words more = {}) const {
    more.insert(more.end(), {"--json", "--no-vtk"});
    const Outcome outcome = bench(more);
    EXPECT_TRUE(succeeded(outcome));
    return json::parse(outcome.out);
  }
};

void expect_interval(const json& row, const char* median, const char* low, const char* high) {
  EXPECT_GT(row.at(median).get<double>(), 0);
  EXPECT_GT(row.at(low).get<double>(), 0);
  EXPECT_LE(row.at(low).get<double>(), row.at(median).get<double>());
  EXPECT_GE(row.at(high).get<double>(), row.at(median).get<double>());
}

TEST_F(Bench, PrintsPositiveMediansAndTheirRatio) {
  const json row = measured({"-s", "hulls=2", "-s", "samples=3"});
  for (const char* subject : {"method", "bare", "opaque"})
    expect_interval(row.at(subject), "frame_ms_median", "frame_ms_ci95_low", "frame_ms_ci95_high");
  expect_interval(row.at("ratio"), "median", "ci95_low", "ci95_high");
  EXPECT_TRUE(row.contains("ratio_without_opaque"));
  EXPECT_EQ(row.at("frames"), 8);
  EXPECT_EQ(row.at("width"), 64);
  EXPECT_EQ(row.at("height"), 48);
  EXPECT_EQ(row.at("parameters").at("hulls"), 2);
  EXPECT_FALSE(row.at("device").get<std::string>().empty());
  EXPECT_FALSE(row.at("clock").get<std::string>().empty());
}

TEST_F(Bench, CountsTheFetchesOfEachBlend) {
  // One of the map and one of the density at each sample: the scene's light casts no shadow.
  EXPECT_EQ(measured({"-s", "samples=3"}).at("fetches_per_blend"), 4);
  EXPECT_EQ(measured({"-s", "samples=8"}).at("fetches_per_blend"), 9);
}

TEST_F(Bench, CountsBlendsWhereTheVolumeIsSeen) {
  const json one = measured({"-s", "hulls=1"});
  const json four = measured({"-s", "hulls=4"});
  const double covered = one.at("blends_per_pixel").get<double>();
  EXPECT_GT(covered, 0);
  EXPECT_LE(covered, 1);
  EXPECT_GT(four.at("blends_per_pixel").get<double>(), covered);
  EXPECT_LE(four.at("blends_per_pixel").get<double>(), 4);
  EXPECT_NEAR(four.at("fetches_per_pixel").get<double>(),
              four.at("blends_per_pixel").get<double>() * four.at("fetches_per_blend").get<double>(), 1e-9);
  const json& rate = four.at("blends_per_second_without_opaque");
  if (rate.is_null()) return;  // the noise hides the hulls
  const auto ms = [&](const char* what) { return four.at(what).at("frame_ms_median").get<double>(); };
  const double pixels = four.at("width").get<double>() * four.at("height").get<double>();
  EXPECT_NEAR(rate.get<double>() * (ms("method") - ms("opaque")) / 1e3,
              four.at("blends_per_pixel").get<double>() * pixels, 1e-6 * pixels);
}

TEST_F(Bench, FollowsTheSettingsOfShadowsAndFrame) {
  const json row = measured({"-s", "shadow.size=64", "-s", "frame.format=single", "-s", "coordinates=single"});
  EXPECT_EQ(row.at("parameters").at("shadow.size"), 64);
  EXPECT_EQ(row.at("parameters").at("frame.format"), "single");
  EXPECT_EQ(row.at("parameters").at("coordinates"), "single");
}

TEST_F(Bench, ComparesWithVtkAtEqualError) {
  const Outcome outcome = bench({"--json"});
  ASSERT_TRUE(succeeded(outcome));
  const json against = json::parse(outcome.out).at("against_vtk");
  ASSERT_FALSE(against.contains("skipped")) << against;
  for (const char* subject : {"method", "vtk"})
    expect_interval(against.at(subject), "frame_ms_median", "frame_ms_ci95_low", "frame_ms_ci95_high");
  expect_interval(against.at("ratio"), "median", "ci95_low", "ci95_high");
  EXPECT_GT(against.at("sample_distance_m").get<double>(), 0);
  const double ours = against.at("method_rmse").get<double>(), theirs = against.at("vtk_rmse").get<double>();
  EXPECT_GT(ours, 0);
  EXPECT_LT(theirs, 0.1) << "VTK draws the same volume";
  EXPECT_EQ(against.at("equal_error").get<bool>(), theirs <= ours);
  EXPECT_EQ(measured().at("against_vtk").at("skipped"), "not asked for");
}

TEST_F(Bench, RoundsFramesUpToWholeBlocks) {
  const Outcome outcome = bench({"--json", "--frames", "9"});
  EXPECT_TRUE(refused(outcome, 2, {"frames"}));  // given twice
  const Outcome once =
      pellucid({"bench", "sampling_hulls", "--scene", scene, "--size", "32x24", "--frames", "9", "--json", "--no-vtk"});
  ASSERT_TRUE(succeeded(once));
  const json row = json::parse(once.out);
  EXPECT_EQ(row.at("frames").get<int>() % row.at("block_frames").get<int>(), 0);
  EXPECT_GE(row.at("frames").get<int>(), 9);
}

TEST_F(Bench, PrintsTheSameForPeople) {
  const Outcome outcome = bench();
  ASSERT_TRUE(succeeded(outcome));
  for (const char* words : {"frame / bare", "blends per pixel", "texture fetches per pixel", "frame / VTK's", "clock"})
    EXPECT_NE(outcome.out.find(words), std::string::npos) << words;
}

TEST_F(Bench, TimesDistanceImpostors) {
  const Outcome outcome = pellucid({"bench", "distance_impostors", "--size", "64x48", "--frames", "8", "-s",
                                    "iterations=3", "-s", "cube_size=64", "--json"});
  ASSERT_TRUE(succeeded(outcome));
  const json row = json::parse(outcome.out);
  expect_interval(row.at("ratio"), "median", "ci95_low", "ci95_high");
  EXPECT_EQ(row.at("scene"), "mirror_room");
  EXPECT_EQ(row.at("fetches_per_blend"), 6);  // r, p, three of l, and the radiance
  EXPECT_GT(row.at("blends_per_pixel").get<double>(), 0.01);
  EXPECT_LT(row.at("blends_per_pixel").get<double>(), 0.2);
  // Between any two blocks the reference traces the same picture: a ray a pixel, the ball's, and those to the lamps.
  const json& reference = row.at("reference");
  expect_interval(reference.at("trace"), "frame_ms_median", "frame_ms_ci95_low", "frame_ms_ci95_high");
  expect_interval(reference.at("ratio"), "median", "ci95_low", "ci95_high");
  EXPECT_GT(reference.at("rays_per_pixel").get<double>(), 1);
  EXPECT_LT(reference.at("rays_per_pixel").get<double>(), 4);
  EXPECT_EQ(reference.at("depth"), 1);
  EXPECT_EQ(reference.at("reflections"), 2);
  const Outcome without = pellucid({"bench", "distance_impostors", "--size", "16x12", "--frames", "8", "-s",
                                    "cube_size=64", "--no-reference", "--json"});
  ASSERT_TRUE(succeeded(without));
  EXPECT_TRUE(json::parse(without.out).at("reference").is_null());
  const Outcome finer = pellucid({"bench", "distance_impostors", "-s", "frame.supersampling=2"});
  EXPECT_TRUE(refused(finer, 2, {"frame.supersampling"}));
}

TEST_F(Bench, TracesAsDeepAsTheFrameShows) {
  const auto reference = [](const Words& more) {
    Words words{"bench", "distance_impostors", "--scene", "spheres_hall",      "--size", "16x12", "--frames", "8",
                "-s",    "cube_size=64",       "-s",      "refractor_size=16", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = pellucid(words);
    EXPECT_TRUE(succeeded(outcome));
    return json::parse(outcome.out).at("reference");
  };
  // In, one reflection inside, out, and the same in the other ball's map.
  const json both = reference({"-s", "internal_reflections=1"});
  EXPECT_EQ(both.at("depth"), 6);
  EXPECT_EQ(both.at("reflections"), 1);
  const json front = reference({"-s", "bounces=1", "-s", "mutual=0"});
  EXPECT_EQ(front.at("depth"), 1);
  EXPECT_EQ(front.at("reflections"), 0);
  EXPECT_LT(front.at("rays_per_pixel").get<double>(), both.at("rays_per_pixel").get<double>());
}

TEST_F(Bench, CountsTheFetchesOfTheGeocubesSearches) {
  const auto measured_glass = [](const Words& more) {
    Words words{"bench", "geocube", "--scene", "glass_ellipsoid", "--size", "64x48", "--frames", "8",
                "-s",    "cubes=1", "-s",      "resolution=16",   "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = pellucid(words);
    EXPECT_TRUE(succeeded(outcome));
    return json::parse(outcome.out);
  };
  // Cone C's radius and both maps for the only step; where it leads out nothing more, elsewhere both maps once more.
  const json shortest = measured_glass({"-s", "iterations=1", "-s", "refine=0", "-s", "reflections=0"});
  const double least = shortest.at("fetches_per_blend").get<double>();
  EXPECT_GE(least, 3);
  EXPECT_LE(least, 5);
  EXPECT_GT(shortest.at("blends_per_pixel").get<double>(), 0.05);
  EXPECT_LT(shortest.at("blends_per_pixel").get<double>(), 0.5);
  EXPECT_NEAR(shortest.at("fetches_per_pixel").get<double>(), shortest.at("blends_per_pixel").get<double>() * least,
              1e-9);
  expect_interval(shortest.at("ratio"), "median", "ci95_low", "ci95_high");
  EXPECT_EQ(shortest.at("reference").at("depth"), 2);
  EXPECT_EQ(shortest.at("reference").at("reflections"), 0);
  // An internal reflection is a second search; every correction fetches both maps.
  const json reflected = measured_glass({"-s", "iterations=1", "-s", "refine=0"});
  EXPECT_GT(reflected.at("fetches_per_blend").get<double>(), 1.5 * least);
  EXPECT_EQ(reflected.at("reference").at("depth"), 3);
  const double two = measured_glass({"-s", "reflections=0"}).at("fetches_per_blend").get<double>();
  const double four = measured_glass({"-s", "reflections=0", "-s", "refine=4"}).at("fetches_per_blend").get<double>();
  EXPECT_NEAR(four - two, 4, 0.2);

  for (const char* setting : {"layers=3", "stage=split", "functions=table"}) {
    EXPECT_TRUE(refused(pellucid({"bench", "geocube", "--scene", "glass_ellipsoid", "-s", setting}), 2,
                        {"bare shader", "functions = evaluated"}));
  }
  EXPECT_TRUE(refused(pellucid({"bench", "geocube", "--scene", "fog_ball", "--size", "16x12"}), 2,
                      {"fog_ball", "no dielectric"}));
}

TEST_F(Bench, CountsTheFetchesOfAReliefsSearches) {
  const auto measured_relief = [](const Words& more) {
    Words words{"bench", "translucent_relief", "--size", "64x48", "--frames", "8", "--no-reference", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = pellucid(words);
    EXPECT_TRUE(succeeded(outcome));
    return json::parse(outcome.out);
  };
  // The height that the ray begins at, four steps, a normal and a colour where it meets the solid; then a halving.
  Words bare_solid{"-s", "translucency=false", "-s", "occlusion=false",
                   "-s", "view_steps=4",       "-s", "view_refinements=0"};
  EXPECT_NEAR(measured_relief(bare_solid).at("fetches_per_blend").get<double>(), 7, 0.1);
  bare_solid.back() = "view_refinements=1";
  EXPECT_NEAR(measured_relief(bare_solid).at("fetches_per_blend").get<double>(), 8, 0.1);
  // A bare shader that lost the searches would take a tenth of the time.
  const json all = measured_relief({});
  EXPECT_GT(all.at("fetches_per_blend").get<double>(), 150);
  EXPECT_GT(all.at("ratio").at("median").get<double>(), 0.6);
  EXPECT_LT(all.at("ratio").at("median").get<double>(), 4);
}

TEST_F(Bench, RefusesWhatItCannotTime) {
  EXPECT_TRUE(refused(pellucid({"bench", "sampling_hull"}), 2, {"sampling_hull", "did you mean 'sampling_hulls'"}));
  EXPECT_TRUE(refused(pellucid({"bench", "volume_slices"}), 2, {"volume_slices", "sampling_hulls"}));
  EXPECT_TRUE(refused(bench({"-s", "hull=4"}), 2, {"hull", "did you mean 'hulls'"}));
  EXPECT_TRUE(refused(bench({"-s", "shadow.sise=4"}), 2, {"sise", "size"}));
  EXPECT_TRUE(refused(pellucid({"bench", "sampling_hulls", "--frames", "1"}), 2, {"frames"}));
  EXPECT_TRUE(refused(pellucid({"bench", "sampling_hulls", "--size", "64"}), 2, {"--size '64'"}));
}

TEST_F(Bench, HelpShowsAnExample) {
  const Outcome help = pellucid({"bench", "--help"});
  ASSERT_TRUE(succeeded(help));
  EXPECT_NE(help.out.find("Example: pellucid bench TECHNIQUE"), std::string::npos);
}

}  // namespace
}  // namespace pellucid::test
