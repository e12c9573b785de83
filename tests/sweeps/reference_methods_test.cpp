// The kinds of a reference: settings as JSON, the shadows' region, the picture of many slices.
#include "sweeps/measure/reference_methods.hpp"

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "gl/context.hpp"
#include "sweeps/measure/measure.hpp"
#include "sweeps/workers/worker_protocol.hpp"
#include "tests/sweeps/fake_known_names.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;
using test::TemporaryFolder;

TEST(ReferenceSettings, SurviveJsonAndTellPointsApart) {
  const ReferenceSettings settings{.method = ReferenceMethod::slices,
                                   .surfaces = ReferenceSurfaces::forward,
                                   .tolerance = 1e-3,
                                   .max_steps = 77,
                                   .slices = 512,
                                   .format = SlicesFormat::single,
                                   .shadow_share = 0.05,
                                   .samples = 9,
                                   .reflections = 3,
                                   .cut = 0.25,
                                   .caustics = true,
                                   .photons = 4096};
  EXPECT_EQ(reference_settings(to_json(settings)), settings);
  EXPECT_NE(to_json(settings), to_json(ReferenceSettings{}));
  json broken = to_json(settings);
  broken["surfaces"] = "vapour";
  EXPECT_THROW(reference_settings(broken), json::exception);
}

TEST(ShadowMask, MarksWhatLosesMoreThanTheShare) {
  Image lit(4, 1, 4), shadowed(4, 1, 4);
  const float luminance[] = {1.0F, 1.0F, 0.5F, 0.0F};
  const float lost[] = {0.04F, 0.06F, 0.5F, 0.0F};
  for (int x = 0; x < 4; ++x) {
    for (int c = 0; c < 3; ++c) {
      lit.at(x, 0)[c] = luminance[x];
      shadowed.at(x, 0)[c] = luminance[x] - lost[x];
    }
    lit.at(x, 0)[3] = 0.25F;  // alpha is no light
    shadowed.at(x, 0)[3] = 1.0F;
  }
  const Image mask = shadow_mask(shadowed, lit, 0.05);
  EXPECT_EQ(mask.channels, 1);
  EXPECT_EQ(mask.pixels, (std::vector<float>{0, 1, 1, 0}));
  EXPECT_EQ(shadow_mask(shadowed, lit, 0.03).pixels, (std::vector<float>{1, 1, 1, 0}));
  // A colour counts by its share of the luminance: blue alone hardly does.
  Image blue = lit;
  blue.at(0, 0)[2] -= 0.6F;
  EXPECT_EQ(shadow_mask(blue, lit, 0.05).pixels[0], 0.0F);
}

// A lamp above a plate in even air: the air below the plate is dark, and so is the floor.
constexpr const char* kPlate = R"(title = "A plate under a lamp"
ambient = 0.02
[views.side]
eye = [0, 1, 5]
target = [0, 1, 0]
[materials.grey]
albedo = 0.5
[meshes.plate]
shape = "box"
size = [0.8, 0.05, 0.8]
[instances.plate]
mesh = "plate"
material = "grey"
position = [0, 1.2, 0]
[meshes.floor]
shape = "plane"
[instances.floor]
mesh = "floor"
material = "grey"
scale = [4, 1, 4]
[lights.lamp]
kind = "spot"
position = [0, 3, 0]
direction = [0, -1, 0]
inner_angle_deg = 25
outer_angle_deg = 35
intensity = [20, 20, 20]
shadow = true
[volume]
kind = "constant"
voxels = [8, 8, 8]
min = [-1.5, 0, -1.5]
max = [1.5, 2.8, 1.5]
extinction = 0.4
[parameters]
lamp = { default = 1, range = [0, 10], mode = "scale", doc = "intensity", drives = ["lights.lamp.intensity"] }
)";

class ReferenceCacheTest : public testing::Test {
 protected:
  void SetUp() override { write_scene(kPlate); }
  void write_scene(const std::string& text) const { std::ofstream(folder / "plate.toml") << text; }
  Point point(const std::string& reference, const std::string& fixed = "hulls = 2\nsamples = 4") {
    const std::string text = "name='s'\nmetrics=['flip','rmse']\n[reference]\ntolerance=1e-3\n" + reference +
                             "\n[[run]]\nname='r'\ntechniques=['sampling_hulls']\nscenes=['plate.toml']\n"
                             "sizes=['64x48']\ntiming.enabled=false\n[run.fixed]\n" +
                             fixed + "\n";
    return make_plan(parse_spec(text, (folder / "s.toml").string())).points.at(0);
  }
  json measure(const Point& p) {
    Measurer measurer([](const char*, double) {});
    return measurer.measure(p, folder / "references").row;
  }
  gl::Context context;
  TemporaryFolder folder;
};

TEST_F(ReferenceCacheTest, TheShadowsRegionHasMetricsOfItsOwn) {
  const json plain = measure(point(""));
  EXPECT_FALSE(plain.contains("rmse_shadow"));
  EXPECT_FALSE(plain.contains("shadow_pixels_share"));
  EXPECT_EQ(plain.at("reference_method"), "exact");
  const json row = measure(point("shadow_share=0.05"));
  EXPECT_EQ(row.at("rmse"), plain.at("rmse"));
  const double share = row.at("shadow_pixels_share");
  EXPECT_GT(share, 0.01);
  EXPECT_LT(share, 0.25);
  EXPECT_GT(row.at("rmse_shadow"), 0.0);
  EXPECT_NE(row.at("rmse_shadow"), row.at("rmse_mask"));
  EXPECT_GT(row.at("flip_mean_shadow"), 0.0);
  EXPECT_LT(measure(point("shadow_share=0.5")).at("shadow_pixels_share"), share);
  // Without light there is no shadow, and nothing to give metrics over.
  const json dark = measure(point("shadow_share=0.05", "scene.lamp = 0"));
  EXPECT_EQ(dark.at("shadow_pixels_share"), 0.0);
  EXPECT_FALSE(dark.contains("rmse_shadow"));
}

TEST_F(ReferenceCacheTest, ForwardSurfacesLeaveTheMediumsErrorAlone) {
  // Without a medium nothing is left of the error but the rounding of the reference's copy.
  std::string clear = kPlate;
  clear.replace(clear.find("extinction = 0.4"), 16, "extinction = 0.0");
  write_scene(clear);
  const std::string fixed = "frame.format = 'single'\nshadow.size = 32";
  EXPECT_LT(measure(point("surfaces='forward'", fixed)).at("rmse"), 1e-6);
  EXPECT_GT(measure(point("surfaces='raster'", fixed)).at("rmse"), 1e-3);
}

TEST_F(ReferenceCacheTest, ThePapersOwnReferenceIsManySlices) {
  const json row = measure(point("method='slices'\nslices=512\nformat='single'"));
  EXPECT_EQ(row.at("reference_method"), "slices");
  const double coarse = measure(point("method='slices'\nslices=8\nformat='single'")).at("reference_to_exact_rmse");
  const double fine = row.at("reference_to_exact_rmse");
  EXPECT_GT(fine, 0.0);
  EXPECT_LT(fine, coarse);
  EXPECT_TRUE(row.at("reference_to_exact_flip_mean").is_number());
  EXPECT_NE(row.at("rmse"), measure(point("")).at("rmse"));
  EXPECT_FALSE(measure(point("")).contains("reference_to_exact_rmse"));
  // The slices drawn as a technique are their own reference.
  Point same = point("method='slices'\nslices=16\nformat='half'");
  same.technique = "volume_slices";
  PointParameters::Table parameters = same.parameters.table();
  for (const char* name : {"hulls", "samples", "sample_offset", "coordinates", "filter_occlusion"})
    parameters.erase(name);
  parameters["slices"] = std::int64_t{16};
  same.parameters = PointParameters(parameters);
  EXPECT_EQ(measure(same).at("rmse"), 0.0);
}

TEST(ReferenceSpec, RefusesWhatDoesNotGoTogether) {
  const test::FakeKnownNames known_names;
  const auto error = [&](const std::string& reference) {
    return test::input_error([&] {
      parse_spec("name='s'\n[reference]\n" + reference + "\n[[run]]\nname='r'\ntechniques=['hulls']\nscenes=['ball']\n",
                 "s.toml", known_names);
    });
  };
  EXPECT_NE(error("method='slice'").find("'slices'"), std::string::npos) << error("method='slice'");
  EXPECT_NE(error("slices=1024").find("s.toml:3:"), std::string::npos) << error("slices=1024");
  EXPECT_NE(error("method='slices'\nslices=5000").find("4096"), std::string::npos);
  EXPECT_NE(error("shadow_share=1.5").find("shadow_share"), std::string::npos);
  EXPECT_NE(error("samples=0").find("samples"), std::string::npos);
  EXPECT_NE(error("reflections=-1").find("reflections"), std::string::npos);
  EXPECT_NE(error("photons=10").find("photons"), std::string::npos);
  EXPECT_NE(error("caustics=1").find("caustics"), std::string::npos);
  EXPECT_NE(error("surfaces='fwd'").find("surfaces"), std::string::npos);
}

}  // namespace
}  // namespace pellucid::sweeps
