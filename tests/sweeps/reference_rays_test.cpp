// References of mirrors, metals and dielectrics: traced, sampled, cached.
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "gl/context.hpp"
#include "sweeps/measure/measure.hpp"
#include "tests/glass_ball.hpp"
#include "tests/sweeps/fake_known_names.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;
using test::TemporaryFolder;

TEST(SettledReference, TakesRaysWhereTheForwardPassCannotDraw) {
  const ReferenceSettings plain;
  EXPECT_EQ(settled(plain, "s", false, true).surfaces, ReferenceSurfaces::raster);
  EXPECT_EQ(settled(plain, "s", true, false).surfaces, ReferenceSurfaces::rays);
  ReferenceSettings sampled;
  sampled.samples = 16;
  EXPECT_EQ(settled(sampled, "s", false, false).surfaces, ReferenceSurfaces::rays);
  ReferenceSettings forward;
  forward.surfaces = ReferenceSurfaces::forward;
  EXPECT_EQ(settled(forward, "s", false, true).surfaces, ReferenceSurfaces::forward);

  EXPECT_EQ(test::input_error([&] { settled(forward, "hall", true, false); }),
            "scene 'hall' has mirrors, metals or dielectrics, which the forward pass does not draw: take surfaces "
            "\"rays\"");
  EXPECT_THROW(settled(plain, "s", true, true), InputError);
  EXPECT_THROW(settled(sampled, "s", false, true), InputError);
  ReferenceSettings slices;
  slices.method = ReferenceMethod::slices;
  EXPECT_THROW(settled(slices, "s", true, false), InputError);
  forward.samples = 2;
  EXPECT_THROW(settled(forward, "s", false, false), InputError);
  forward.samples = 1;
  forward.caustics = true;
  EXPECT_THROW(settled(forward, "s", false, false), InputError);
}

TEST(SettledReference, IsCheckedBeforeTheFirstFrame) {
  test::FakeKnownNames known_names;
  known_names.ball.interfaces = true;
  const auto plan = [&](const std::string& reference) {
    return make_plan(parse_spec("name='s'\n[[run]]\nname='r'\ntechniques=['hulls']\nscenes=['ball']\n" + reference,
                                "s.toml", known_names),
                     known_names);
  };
  EXPECT_EQ(plan("").points.at(0).reference.surfaces, ReferenceSurfaces::rays);
  const std::string error = test::input_error([&] { plan("reference.surfaces='raster'\n"); });
  EXPECT_TRUE(error.starts_with("s.toml:2:")) << error;
  EXPECT_NE(error.find("mirrors"), std::string::npos) << error;
  EXPECT_EQ(plan("metrics=[]\nreference.surfaces='raster'\n").points.size(), 1U) << "nothing is compared";
  EXPECT_EQ(plan("").points[0].id, plan("reference.surfaces='rays'\n").points[0].id);
  EXPECT_NE(plan("").points[0].id, plan("reference.samples=4\n").points[0].id);
}

class RaysReference : public testing::Test {
 protected:
  void SetUp() override { std::ofstream(folder / "ball.toml") << ::pellucid::test::kGlassBall; }
  json measure(const std::string& reference) {
    const std::string text =
        "name='s'\nmetrics=['rmse']\n[reference]\n" + reference +
        "\n[[run]]\nname='r'\ntechniques=['environment_map']\nscenes=['ball.toml']\nsizes=['48x36']\n"
        "timing.enabled=false\n[run.fixed]\nframe.format='single'\n";
    const Plan plan = make_plan(parse_spec(text, (folder / "s.toml").string()));
    Measurer measurer([](const char*, double) {});
    return measurer.measure(plan.points.at(0), folder / "references").row;
  }
  std::size_t files() const {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& file : std::filesystem::directory_iterator(folder / "references"))
      ++count;
    return count;
  }
  gl::Context context;
  TemporaryFolder folder;
};

TEST_F(RaysReference, MasksTheObjectAndStatesItsErrors) {
  const json centre = measure("");
  EXPECT_EQ(centre.at("reference_samples"), 1);
  EXPECT_EQ(centre.at("reference_standard_error_max"), 0.0);
  EXPECT_GT(centre.at("rmse_mask"), centre.at("rmse")) << "the error is the ball's";
  EXPECT_LT(centre.at("reference_cut_weight_max"), 0.01);
  EXPECT_EQ(centre.at("reference_lost_weight_mean"), 0.0);
  EXPECT_EQ(files(), 1U);
  const json sampled = measure("samples=8");
  EXPECT_EQ(sampled.at("reference_samples"), 8);
  EXPECT_GT(sampled.at("reference_standard_error_max"), sampled.at("reference_standard_error_mean"));
  EXPECT_EQ(files(), 2U);
  EXPECT_NE(measure("reflections=0").at("rmse"), centre.at("rmse"));
  const json caustics = measure("caustics=true\nphotons=65536");
  EXPECT_GT(caustics.at("reference_caustic_error_max"), 0.0);
  EXPECT_GT(caustics.at("rmse"), 0.0);
  EXPECT_EQ(files(), 4U);
  // From the files, the errors with the pixels.
  const json again = measure("caustics=true\nphotons=65536");
  EXPECT_EQ(files(), 4U);
  for (const char* field : {"rmse", "rmse_mask", "reference_caustic_error_max", "reference_trace_s"})
    EXPECT_EQ(again.at(field), caustics.at(field)) << field;
}

}  // namespace
}  // namespace pellucid::sweeps
