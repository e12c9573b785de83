#include "sweeps/spec/spec.hpp"

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "tests/sweeps/fake_known_names.hpp"

namespace pellucid::sweeps {
namespace {

using test::FakeKnownNames;
using test::input_error;

Spec parse(const std::string& text) {
  return parse_spec(text, "s.toml", FakeKnownNames());
}

TEST(Spec, ReadsEverything) {
  const Spec spec = parse(R"(
name = "curves"
title = "Curves"
description = "of error"
metrics = ["flip", "rmse"]
timeout_s = 12.5
[timing]
max_seconds = 4
[reference]
tolerance = 1e-3
[[run]]
name = "a"
techniques = ["hulls", "slices"]
scenes = ["forest"]
views = ["inside"]
sizes = ["64x48", "720x540"]
combine = "grid"
constraints = ["hulls * samples <= 64"]
baseline = true
[run.axes]
samples = { from = 1, to = 8, log2 = true }
hulls = [4, 1]
scene.density = { from = 0.5, to = 2, steps = 4 }
[run.fixed]
frame.format = "single"
"filter" = true
[run.timing]
min_samples = 10
[[run]]
name = "b"
techniques = ["slices"]
scenes = ["ball"]
metrics = ["psnr"]
timing = { enabled = false }
reference.surfaces = "rays"
)");
  EXPECT_EQ(spec.name, "curves");
  EXPECT_EQ(spec.title, "Curves");
  EXPECT_EQ(spec.description, "of error");
  EXPECT_EQ(spec.timeout_s, 12.5);
  ASSERT_EQ(spec.blocks.size(), 2U);
  const RunBlock& a = spec.blocks[0];
  EXPECT_EQ(a.techniques, (std::vector<std::string>{"hulls", "slices"}));
  EXPECT_EQ(a.views, std::vector<std::string>{"inside"});
  ASSERT_EQ(a.sizes.size(), 2U);
  EXPECT_EQ(a.sizes[1].width, 720);
  EXPECT_EQ(a.sizes[1].height, 540);
  ASSERT_EQ(a.axes.size(), 3U);  // in the order of the file
  EXPECT_EQ(a.axes[0].name, "samples");
  EXPECT_EQ(a.axes[0].values, (std::vector<Value>{std::int64_t{1}, std::int64_t{2}, std::int64_t{4}, std::int64_t{8}}));
  EXPECT_EQ(a.axes[1].values, (std::vector<Value>{std::int64_t{4}, std::int64_t{1}}));
  EXPECT_EQ(a.axes[2].name, "scene.density");
  EXPECT_EQ(a.axes[2].values, (std::vector<Value>{0.5, 1.0, 1.5, 2.0}));
  ASSERT_EQ(a.fixed.size(), 2U);
  EXPECT_EQ(a.fixed[0].name, "frame.format");
  EXPECT_EQ(a.fixed[1].value, Value(true));
  EXPECT_EQ(a.metrics, (std::vector<std::string>{"flip", "rmse"}));
  EXPECT_TRUE(a.baseline);
  EXPECT_EQ(a.timing.min_samples, 10);
  EXPECT_EQ(a.timing.max_seconds, 4);
  EXPECT_EQ(a.reference.tolerance, 1e-3);
  const RunBlock& b = spec.blocks[1];
  EXPECT_FALSE(b.timing.enabled);
  EXPECT_EQ(b.timing.min_samples, 30);  // the first block's override is its own
  EXPECT_EQ(b.reference.surfaces, ReferenceSurfaces::rays);
  EXPECT_EQ(b.metrics, std::vector<std::string>{"psnr"});
  EXPECT_EQ(b.sizes.front().width, 720);
}

TEST(Spec, GroupsNeedNoQuotes) {
  const Spec spec = parse(
      "name='s'\n[[run]]\nname='r'\ntechniques=['hulls']\nscenes=['ball']\n[run.axes]\nshadow.size=[64,128]\n"
      "scene.density=[1,2]\n[run.fixed]\nframe.format='single'\nshadow.blur=2.5\n");
  const RunBlock& block = spec.blocks.at(0);
  ASSERT_EQ(block.axes.size(), 2U);
  EXPECT_EQ(block.axes[0].name, "shadow.size");
  EXPECT_EQ(block.axes[1].name, "scene.density");
  ASSERT_EQ(block.fixed.size(), 2U);
  EXPECT_EQ(block.fixed[1].name, "shadow.blur");
}

TEST(Spec, AZipMayRepeatAValue) {
  const Spec spec = parse(
      "name='s'\n[[run]]\nname='r'\ntechniques=['hulls']\nscenes=['ball']\ncombine='zip'\n[run.axes]\n"
      "hulls=[2,4,4]\nsamples=[4,4,8]\n");
  EXPECT_EQ(spec.blocks.at(0).axes.at(0).values,
            (std::vector<Value>{std::int64_t{2}, std::int64_t{4}, std::int64_t{4}}));
}

TEST(Spec, AScenesPathCountsFromTheSpec) {
  const Spec spec = parse_spec("name='s'\n[[run]]\nname='r'\ntechniques=['hulls']\nscenes=['../ball.toml']\n",
                               "a/b/s.toml", FakeKnownNames());
  EXPECT_EQ(spec.blocks[0].scenes[0], "a/ball.toml");
}

TEST(Spec, RangesWithStepsAndLog2AreGeometric) {
  const Spec spec = parse(
      "name='s'\n[[run]]\nname='r'\ntechniques=['hulls']\nscenes=['ball']\n[run.axes]\n"
      "scene.density={from=0.01,to=1,steps=3,log2=true}\n");
  ASSERT_EQ(spec.blocks[0].axes[0].values.size(), 3U);
  EXPECT_DOUBLE_EQ(std::get<double>(spec.blocks[0].axes[0].values[1]), 0.1);
  EXPECT_EQ(spec.blocks[0].axes[0].values[2], Value(1.0));
}

struct Wrong {
  const char* what;
  const char* text;     ///< from its third line on: lines 1 and 2 name the spec and a blank
  const char* message;  ///< what the error must start with
};

class SpecErrors : public testing::TestWithParam<Wrong> {};

TEST_P(SpecErrors, NameThePlace) {
  const std::string text = std::string("name = \"s\"\n\n") + GetParam().text;
  const std::string message = input_error([&] { parse(text); });
  EXPECT_EQ(message.substr(0, std::string(GetParam().message).size()), GetParam().message) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

// Lines 3 to 6: the start of a sound block.
#define BLOCK "[[run]]\nname = \"r\"\ntechniques = [\"hulls\"]\nscenes = [\"forest\"]\n"

INSTANTIATE_TEST_SUITE_P(
    Table, SpecErrors,
    testing::Values(
        Wrong{"syntax", "title = \n", "s.toml:3:9: "}, Wrong{"duplicate", "name = \"t\"\n", "s.toml:3:8: "},
        Wrong{"no_run", "title = \"x\"\n", "s.toml:1:1: the spec has no [[run]] block"},
        Wrong{"run_not_list", "[run]\nname = \"r\"\n", "s.toml:3:1: run must be a list of tables, not a table"},
        Wrong{"unknown_top", "titel = \"x\"\n" BLOCK, "s.toml:3:1: unknown key 'titel'; did you mean 'title'?"},
        Wrong{"unknown_run", BLOCK "axis = 3\n", "s.toml:7:1: unknown key 'axis' in run[0]; did you mean 'axes'?"},
        Wrong{"unknown_timing", "[timing]\nmax_second = 3\n" BLOCK,
              "s.toml:4:1: unknown key 'max_second' in timing; did you mean 'max_seconds'?"},
        Wrong{"title_type", "title = 3\n" BLOCK, "s.toml:3:9: title must be a string, not an integer"},
        Wrong{"timeout_range", "timeout_s = 0\n" BLOCK, "s.toml:3:13: timeout_s = 0 is out of range [0.1, 86400]"},
        Wrong{"timeout_nan", "timeout_s = nan\n" BLOCK, "s.toml:3:13: timeout_s = nan is out of range"},
        Wrong{"samples_type", "[timing]\nmin_samples = 3.5\n" BLOCK,
              "s.toml:4:15: timing.min_samples must be an integer, not a number"},
        Wrong{"samples_order", "[timing]\nmax_samples = 3\n" BLOCK,
              "s.toml:4:15: max_samples = 3 is below min_samples = 30"},
        Wrong{"surfaces", "reference.surfaces = \"ray\"\n" BLOCK,
              "s.toml:3:22: reference.surfaces = 'ray' is not one of automatic, raster, forward, rays; did you mean "
              "'rays'?"},
        Wrong{"metric", "metrics = [\"rmse\", \"flp\"]\n" BLOCK,
              "s.toml:3:20: unknown metric 'flp'; did you mean 'flip'?"},
        Wrong{"metric_twice", "metrics = [\"rmse\", \"rmse\"]\n" BLOCK, "s.toml:3:20: metrics lists 'rmse' twice"},
        Wrong{"no_name", "[[run]]\ntechniques = [\"hulls\"]\nscenes = [\"forest\"]\n",
              "s.toml:3:1: 'name' is missing in run[0]"},
        Wrong{"bad_name", "[[run]]\nname = \"R 1\"\n", "s.toml:4:8: name = 'R 1' is not a name of a-z, 0-9 and _"},
        Wrong{"two_blocks", BLOCK BLOCK, "s.toml:8:8: a second block named 'r'"},
        Wrong{"no_scenes", "[[run]]\nname = \"r\"\ntechniques = [\"hulls\"]\n",
              "s.toml:3:1: 'scenes' is missing in run[0]"},
        Wrong{"no_technique", "[[run]]\nname = \"r\"\ntechniques = []\n", "s.toml:5:14: techniques is empty"},
        Wrong{"technique", "[[run]]\nname = \"r\"\ntechniques = [\"hull\"]\nscenes = [\"forest\"]\n",
              "s.toml:5:15: unknown technique 'hull'"},
        Wrong{"scene", "[[run]]\nname = \"r\"\ntechniques = [\"hulls\"]\nscenes = [\"forrest\"]\n",
              "s.toml:6:11: unknown scene 'forrest'"},
        Wrong{"view", BLOCK "views = [\"insides\"]\n",
              "s.toml:7:10: unknown view of scene forest 'insides'; did you mean 'inside'?"},
        Wrong{"size_form", BLOCK "sizes = [\"720*540\"]\n", "s.toml:7:10: size '720*540' is not WIDTHxHEIGHT"},
        Wrong{"size_huge", BLOCK "sizes = [\"100000x100000\"]\n", "s.toml:7:10: "},
        Wrong{"combine", BLOCK "combine = \"gird\"\n",
              "s.toml:7:11: run[0].combine = 'gird' is not one of grid, zip; did you mean 'grid'?"},
        Wrong{"axis_name", BLOCK "[run.axes]\nhull = [1]\n",
              "s.toml:8:1: unknown parameter 'hull' of hulls; did you mean 'hulls'?"},
        Wrong{"axis_scene_name", BLOCK "[run.axes]\nscene.densty = [1]\n",
              "s.toml:8:7: unknown parameter 'densty' of scene forest; did you mean 'density'?"},
        Wrong{"axis_frame_name", BLOCK "[run.axes]\n\"frame.fomat\" = [\"half\"]\n",
              "s.toml:8:1: unknown parameter 'fomat' of frame; did you mean 'format'?"},
        Wrong{"axis_range", BLOCK "[run.axes]\nhulls = [1, 2, 65]\n",
              "s.toml:8:16: hulls: hulls = 65 is out of range [1, 64]"},
        Wrong{"axis_type", BLOCK "[run.axes]\nhulls = [1, 2.5]\n",
              "s.toml:8:13: hulls: hulls = 2.5 is not an integer in [1, 64]"},
        Wrong{"axis_choice", BLOCK "[run.axes]\nformat = [\"singel\"]\n",
              "s.toml:8:11: hulls: format = 'singel' is not one of automatic, unorm8, single; did you mean 'single'?"},
        Wrong{"axis_date", BLOCK "[run.axes]\nhulls = [1979-05-27]\n",
              "s.toml:8:10: hulls is a boolean, a number or a string, not a date or time"},
        Wrong{"axis_empty", BLOCK "[run.axes]\nhulls = []\n", "s.toml:8:9: axis hulls lists no value"},
        Wrong{"axis_twice", BLOCK "[run.axes]\nhulls = [1, 2, 1]\n", "s.toml:8:16: axis hulls lists 1 twice"},
        Wrong{"axis_twice_real", BLOCK "[run.axes]\noffset = [1, 1.0]\n", "s.toml:8:14: axis offset lists 1 twice"},
        Wrong{"axis_scalar", BLOCK "[run.axes]\nhulls = 4\n", "s.toml:8:9: axis hulls is a list of values or a range"},
        Wrong{"axis_two_spellings", BLOCK "[run.axes]\nscene.density = [1]\n\"scene.density\" = [2]\n",
              "s.toml:9:1: scene.density is given twice"},
        Wrong{"range_key", BLOCK "[run.axes]\nhulls = { from = 1, to = 4, step = 2 }\n",
              "s.toml:8:29: unknown key 'step' in run[0].axes.hulls; did you mean 'steps'?"},
        Wrong{"range_lacks", BLOCK "[run.axes]\nhulls = { from = 1, steps = 2 }\n",
              "s.toml:8:9: 'to' is missing in run[0].axes.hulls"},
        Wrong{"range_bare", BLOCK "[run.axes]\nhulls = { from = 1, to = 4 }\n",
              "s.toml:8:9: hulls: a range needs `steps` or `log2 = true`"},
        Wrong{"range_order", BLOCK "[run.axes]\nhulls = { from = 4, to = 1, steps = 2 }\n",
              "s.toml:8:9: hulls: a range needs from < to"},
        Wrong{"range_fraction", BLOCK "[run.axes]\nhulls = { from = 1, to = 4, steps = 3 }\n",
              "s.toml:8:9: hulls: the range falls on 2.5, and hulls is an integer"},
        Wrong{"range_doubling", BLOCK "[run.axes]\nhulls = { from = 3, to = 32, log2 = true }\n",
              "s.toml:8:9: hulls: doubling from 3 does not meet 32"},
        Wrong{"range_zero", BLOCK "[run.axes]\noffset = { from = 0, to = 1, log2 = true }\n",
              "s.toml:8:10: offset: a log2 range needs from > 0"},
        Wrong{"range_steps", BLOCK "[run.axes]\noffset = { from = 0, to = 1, steps = 1 }\n",
              "s.toml:8:10: offset: steps = 1 is out of range [2, 100000]"},
        Wrong{"range_steps_huge", BLOCK "[run.axes]\noffset = { from = 0, to = 1, steps = 9000000000000000000 }\n",
              "s.toml:8:10: offset: steps = 9000000000000000000 is out of range"},
        Wrong{"range_inf", BLOCK "[run.axes]\noffset = { from = 0, to = inf, steps = 3 }\n",
              "s.toml:8:10: offset: a range needs"},
        Wrong{"range_values", BLOCK "[run.axes]\nhulls = { from = 1, to = 128, log2 = true }\n",
              "s.toml:8:9: hulls: hulls = 128 is out of range [1, 64]"},
        Wrong{"range_choice", BLOCK "[run.axes]\nformat = { from = 1, to = 2, steps = 2 }\n",
              "s.toml:8:10: format: a range needs a number, and format is a choice"},
        Wrong{"fixed_name", BLOCK "[run.fixed]\nsample = 3\n",
              "s.toml:8:1: unknown parameter 'sample' of hulls; did you mean 'samples'?"},
        Wrong{"fixed_list", BLOCK "[run.fixed]\nsamples = [3]\n",
              "s.toml:8:11: samples is a boolean, a number or a string, not a list"},
        Wrong{"fixed_and_axis", BLOCK "[run.axes]\nhulls = [1]\n[run.fixed]\nhulls = 2\n",
              "s.toml:10:1: hulls is an axis of this block already"},
        Wrong{"zip_lengths", BLOCK "combine = \"zip\"\n[run.axes]\nhulls = [1, 2]\nsamples = [1, 2, 3]\n",
              "s.toml:10:1: a zip needs axes of equal length: samples has 3 values, hulls has 2"},
        Wrong{"zip_empty", BLOCK "combine = \"zip\"\n", "s.toml:3:1: combine = \"zip\" needs [run.axes]"},
        Wrong{"baseline_untimed", BLOCK "baseline = true\ntiming.enabled = false\n",
              "s.toml:7:12: the baseline is re-measured for its time; its block needs timing"},
        Wrong{"nothing", BLOCK "metrics = []\ntiming.enabled = false\n",
              "s.toml:3:1: block 'r' has neither timing nor metrics"},
        Wrong{"two_baselines",
              BLOCK "baseline = true\n[[run]]\nname = \"q\"\ntechniques = [\"hulls\"]\nscenes = [\"ball\"]\n"
                    "baseline = true\n",
              "s.toml:12:12: block 'r' is the baseline already"}),
    [](const auto& wrong) { return std::string(wrong.param.what); });

TEST(Spec, MissingFilesAndNames) {
  EXPECT_EQ(input_error([] { load_spec("/nowhere/x.toml", FakeKnownNames()); }),
            "cannot read spec '/nowhere/x.toml': No such file or directory");
  EXPECT_EQ(input_error([] { load_spec("no_such_spec", FakeKnownNames()); }).substr(0, 29),
            "no spec named 'no_such_spec';");
}

TEST(Spec, RefusesAHugeFile) {
  EXPECT_EQ(input_error([] { parse(std::string(2 << 20, ' ')); }), "s.toml: a spec may have 1048576 bytes");
}

}  // namespace
}  // namespace pellucid::sweeps
