// The parts of the window, without a window.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "algorithms/scene/view_text.hpp"
#include "gl/error.hpp"
#include "sandbox/viewer/camera/drag_parameter.hpp"
#include "sandbox/viewer/camera/frame_range.hpp"
#include "sandbox/viewer/camera/orbit.hpp"
#include "sandbox/viewer/camera/path.hpp"
#include "sandbox/viewer/compare/statistics.hpp"
#include "sandbox/viewer/live/sweep_here.hpp"
#include "sandbox/viewer/state/bookmarks.hpp"
#include "sandbox/viewer/state/parameter_json.hpp"
#include "sweeps/spec/plan.hpp"
#include "tests/sandbox/program.hpp"
#include "tests/temporary_folder.hpp"

namespace pellucid::sandbox {
namespace {

View example() {
  View view;
  view.eye = {1, 2, 5};
  view.target = {0, 1, 0};
  return view;
}

TEST(Camera, OrbitsAtItsDistanceWithALevelHorizon) {
  const View from = example();
  const View to = orbit(from, 120, -35, 540);
  EXPECT_EQ(to.target, from.target);
  EXPECT_NEAR(glm::length(to.eye - to.target), glm::length(from.eye - from.target), 1e-4);
  EXPECT_EQ(to.up, from.up);
  // Half a turn over the height of the picture, and back.
  const View opposite = orbit(from, 540, 0, 540);
  EXPECT_NEAR(opposite.eye.x, -from.eye.x, 1e-4);
  EXPECT_NEAR(opposite.eye.z, -from.eye.z, 1e-4);
  // Never over the pole.
  const View high = orbit(from, 0, 5000, 540);
  EXPECT_LT(std::abs(glm::normalize(high.target - high.eye).y), 1.0F - 1e-5F);
}

TEST(Camera, PansSoThatTheTargetFollowsThePointer) {
  Camera camera{example(), 640, 480};
  camera.view = pan(camera.view, 64, -48, 480);
  // The point that was in the middle is now 64 pixels to the right and 48 up.
  const glm::dvec3 towards = camera.ray_direction(320 + 64, 240 - 48);
  const glm::dvec3 old_target(example().target);
  const glm::dvec3 wanted = glm::normalize(old_target - glm::dvec3(camera.view.eye));
  EXPECT_NEAR(glm::length(towards - wanted), 0, 1e-5);
}

TEST(Camera, GoesAlongAPathThroughItsViews) {
  std::vector<View> stops{example(), example(), example()};
  stops[1].eye = {4, 2, 0};
  stops[2].fov_y_deg = 20;
  EXPECT_EQ(view_along(stops, 0).eye, stops[0].eye);
  EXPECT_EQ(view_along(stops, 0.5).eye, stops[1].eye);
  EXPECT_EQ(view_along(stops, 1).fov_y_deg, 20.0F);
  const float before = view_along(stops, 0.499).eye.x, after = view_along(stops, 0.501).eye.x;
  EXPECT_NEAR(before, after, 0.05);
}

TEST(Camera, DragsAnObjectSoThatItFollowsThePointer) {
  const auto placed = [](const char* name) {
    ParameterInfo info;
    info.name = name;
    info.min = -5;
    info.max = 5;
    info.default_value = 0.0;
    return info;
  };
  const std::vector<ParameterInfo> infos{placed("ball_x"), placed("ball_y_m"), placed("lamp_x"), placed("size")};
  const auto get = [](const std::string&) -> Value { return 0.0; };
  View view;  // along -z, 5 m from the target
  const auto moved = dragged("ball_x", infos, get, view, 50, -25, 640, 480);
  ASSERT_EQ(moved.size(), 2U);
  const double per_pixel = 2 * 5 * std::tan(0.5 * 45 * std::acos(-1) / 180) / 480;
  EXPECT_NEAR(std::get<double>(moved[0].second), 50 * per_pixel, 1e-5);
  EXPECT_NEAR(std::get<double>(moved[1].second), 25 * per_pixel, 1e-5);
  // A parameter that is no place moves as its slider would: the picture's width is the range.
  EXPECT_EQ(dragged("size", infos, get, view, 64, 0, 640, 480).front().second, Value(1.0));
  EXPECT_EQ(first_placement(infos), "ball_x");
}

TEST(Frames, AreReadAndNumbered) {
  EXPECT_EQ(parse_frames("0:120").count(), 121);
  EXPECT_EQ(parse_frames("7").first, 7);
  for (const char* wrong : {"", "3:1", "-1:4", "a:b", "1:2:3"})
    EXPECT_THROW(parse_frames(wrong), InputError) << wrong;
  EXPECT_EQ(numbered("out.%04d.exr", 12), "out.0012.exr");
  EXPECT_EQ(numbered("%d.png", 3), "3.png");
  for (const char* wrong : {"out.exr", "out.%s.exr", "%d_%d.exr", "%", "%99999d.exr"})
    EXPECT_THROW(numbered(wrong, 1), InputError) << wrong;
}

TEST(Statistics, AreThoseOfTheBoxAlone) {
  Image image(4, 3, 4);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 4; ++x)
      image.at(x, y)[0] = static_cast<float>(x);
  image.at(2, 1)[1] = std::numeric_limits<float>::quiet_NaN();
  const BoxStatistics s = statistics_of(image, {1, 0, 9, 2});  // reaches beyond the image
  EXPECT_EQ(s.pixels, 6U);
  EXPECT_EQ(s.not_finite, 1U);
  EXPECT_DOUBLE_EQ(s.mean[0], 2);
  EXPECT_DOUBLE_EQ(s.min[0], 1);
  EXPECT_DOUBLE_EQ(s.max[0], 3);
  EXPECT_NEAR(s.deviation[0], std::sqrt(2.0 / 3), 1e-12);
  std::size_t counted = 0;
  for (const std::size_t n : s.counts[0])
    counted += n;
  EXPECT_EQ(counted, 6U);
  EXPECT_EQ(statistics_of(image, {3, 3, 1, 1}).pixels, 0U);
}

TEST(Bookmarks, SurviveAndAreNeverWrittenOver) {
  test::TemporaryFolder folder;
  const auto file = folder / "config" / "bookmarks.json";
  ViewState state;
  state.scene = "fog_forest";
  state.technique = "sampling_hulls";
  state.parameters = {{"hulls", std::int64_t{4}}, {"scene.density", 0.5}, {"frame.format", std::string("single")}};
  Bookmarks(file).put("mist", state);
  Bookmarks again(file);
  ASSERT_NE(again.find("mist"), nullptr);
  EXPECT_EQ(*again.find("mist"), state);
  again.remove("mist");
  EXPECT_TRUE(Bookmarks(file).all().empty());

  test::write_file(file, R"({"version": 1, "bookmarks": [{"name": "x"}]})");
  Bookmarks broken(file);
  EXPECT_NE(broken.trouble().find("bookmarks.json"), std::string::npos);
  broken.put("new", state);
  EXPECT_TRUE(std::filesystem::exists(file.string() + ".damaged_1"));
  EXPECT_EQ(Bookmarks(file).all().size(), 1U);

  // A folder that cannot be made: nothing changes.
  Bookmarks nowhere("/proc/none/bookmarks.json");
  EXPECT_THROW(nowhere.put("y", state), RuntimeError);
  EXPECT_TRUE(nowhere.all().empty());
}

TEST(SweepHere, WritesASpecThatHoldsTheViewAndTheRest) {
  test::TemporaryFolder folder;
  ViewState state;
  state.scene = test::write_small_scene(folder).string();
  state.technique = "sampling_hulls";
  state.view = "side:eye=3,1,1";
  state.width = 48;
  state.height = 36;
  state.parameters = {{"hulls", std::int64_t{4}}, {"scene.density", 0.5}, {"frame.format", std::string("single")}};
  const auto values = std::vector<Value>{std::int64_t{1}, std::int64_t{2}, std::int64_t{8}};
  const sweeps::Spec spec = sweeps::parse_spec(sweep_spec(state, "hulls", values, "here"), "here.toml");
  const sweeps::Plan plan = sweeps::make_plan(spec);
  ASSERT_EQ(plan.points.size(), 3U);
  EXPECT_EQ(plan.points[0].view, state.view);
  EXPECT_EQ(plan.points[2].parameters.at("hulls"), Value(std::int64_t{8}));
  EXPECT_EQ(plan.points[0].parameters.at("scene.density"), Value(0.5));
  EXPECT_EQ(plan.points[0].parameters.at("frame.format"), Value(std::string("single")));
  EXPECT_EQ(plan.points[0].size.width, 48);
}

TEST(SweepHere, SpreadsItsValuesOverTheRange) {
  ParameterInfo info;
  info.name = "n";
  info.type = ValueType::integer;
  info.min = 1;
  info.max = 64;
  info.default_value = std::int64_t{4};
  const auto doubled = sweep_values(info, 9);
  EXPECT_EQ(doubled.front(), Value(std::int64_t{1}));
  EXPECT_EQ(doubled.back(), Value(std::int64_t{64}));
  info.type = ValueType::real;
  info.default_value = 2.0;
  EXPECT_EQ(sweep_values(info, 4).size(), 4U);
  EXPECT_EQ(sweep_values(info, 4).back(), Value(64.0));
  info.type = ValueType::boolean;
  EXPECT_EQ(sweep_values(info, 9).size(), 2U);
}

TEST(ParameterJson, ReadsBackEveryDeclaration) {
  for (const TechniqueInfo& technique : techniques()) {
    const auto infos = technique.table().infos();
    const auto read = parameters_from_json(nlohmann::json::parse(parameters_json(infos).dump()));
    ASSERT_EQ(read.size(), infos.size());
    for (std::size_t i = 0; i < infos.size(); ++i) {
      EXPECT_EQ(read[i].name, infos[i].name);
      EXPECT_EQ(read[i].default_value, infos[i].default_value) << infos[i].name;
      EXPECT_EQ(read[i].choices, infos[i].choices);
      EXPECT_EQ(read[i].when, infos[i].when);
      EXPECT_EQ(read[i].max, infos[i].max);
    }
  }
}

TEST(RenderFrames, FollowTheTime) {
  test::TemporaryFolder folder;
  std::string text = test::read_file(test::write_small_scene(folder));
  const std::string scene = folder.write("moving.scene.toml", text).string();
  const auto out = (folder / "f.%03d.exr").string();
  // Through two views, since nothing else moves here.
  const test::Outcome outcome = test::pellucid({"render", scene, "-t", "volume_slices", "--size", "32x24", "--frames",
                                                "2:4", "--view", "front", "--through", "side", "-o", out});
  ASSERT_TRUE(test::succeeded(outcome));
  const ImageFile last = read_image(folder / "f.004.exr");
  const test::Outcome still = test::pellucid({"render", scene, "-t", "volume_slices", "--size", "32x24", "--view",
                                              "side", "-o", (folder / "still.exr").string()});
  ASSERT_TRUE(test::succeeded(still));
  EXPECT_EQ(last.image.pixels, read_image(folder / "still.exr").image.pixels);
  EXPECT_NE(read_image(folder / "f.003.exr").image.pixels, last.image.pixels);
  EXPECT_TRUE(test::refused(test::pellucid({"render", scene, "-t", "volume_slices", "--through", "side", "-o", out}), 2,
                            {"--frames"}));
}

}  // namespace
}  // namespace pellucid::sandbox
