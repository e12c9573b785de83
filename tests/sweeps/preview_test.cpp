#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sweeps/spec/plan.hpp"
#include "tests/sweeps/fake_known_names.hpp"

namespace pellucid::sweeps {
namespace {

using test::FakeKnownNames;
using test::input_error;

const std::string kPreviewSpec = R"(name = "curves"
metrics = ["flip", "rmse"]
[timing]
min_samples = 30
max_seconds = 4
[[run]]
name = "a"
techniques = ["hulls"]
scenes = ["forest"]
sizes = ["720x540"]
[run.axes]
samples = { from = 1, to = 8, log2 = true }
hulls = [4, 1]
scene.density = [0.5, 2.0]
[[run]]
name = "b"
techniques = ["slices"]
scenes = ["forest", "ball"]
[run.axes]
samples = [1, 2]
[[run]]
name = "c"
techniques = ["slices"]
scenes = ["ball"]
)";

Spec with_overlay(const std::string& overlay, Extent extent = Extent::preview) {
  return parse_spec(kPreviewSpec + overlay, "s.toml", FakeKnownNames(), extent);
}

std::vector<std::string> texts(const Axis& axis) {
  std::vector<std::string> out;
  for (const Value& value : axis.values)
    out.push_back(to_text(value));
  return out;
}

TEST(Preview, ChangesWhatItNamesAndNothingElse) {
  const std::string overlay = R"([preview]
title = "Curves, in a minute"
metrics = ["flip"]
sizes = ["64x48"]
omit = ["c"]
[preview.timing]
max_seconds = 0.5
[preview.axes]
scene.density = [1.0]
samples = [2, 8]
[preview.run]
a.axes.hulls = [2]
b.scenes = ["ball"]
b.timing.enabled = false
b.axes.samples = [1]
)";
  const Spec full = with_overlay(overlay, Extent::full);
  EXPECT_EQ(full.name, "curves");
  EXPECT_EQ(full.blocks.size(), 3U);
  EXPECT_EQ(full.blocks[0].axes[0].values.size(), 4U);

  const Spec spec = with_overlay(overlay);
  EXPECT_EQ(spec.name, "curves_preview");
  EXPECT_EQ(spec.title, "Curves, in a minute");
  ASSERT_EQ(spec.blocks.size(), 2U);
  const RunBlock& a = spec.blocks[0];
  EXPECT_EQ(a.metrics, std::vector<std::string>{"flip"});
  EXPECT_EQ(a.sizes.at(0).width, 64);
  EXPECT_EQ(a.timing.min_samples, 30);
  EXPECT_EQ(a.timing.max_seconds, 0.5);
  ASSERT_EQ(a.axes.size(), 3U);
  EXPECT_EQ(a.axes[0].name, "samples") << "axes stay in the order of the spec";
  EXPECT_EQ(texts(a.axes[0]), (std::vector<std::string>{"2", "8"}));
  EXPECT_EQ(texts(a.axes[1]), std::vector<std::string>{"2"});
  EXPECT_EQ(texts(a.axes[2]), std::vector<std::string>{"1"});
  const RunBlock& b = spec.blocks[1];
  EXPECT_EQ(b.scenes, std::vector<std::string>{"ball"});
  EXPECT_FALSE(b.timing.enabled);
  EXPECT_EQ(texts(b.axes[0]), std::vector<std::string>{"1"}) << "a block's own key wins over that of all";
}

TEST(Preview, ScenesAreReplacedByListOrByStandIn) {
  const Spec list = with_overlay("[preview]\nscenes = ['ball']\n");
  for (const RunBlock& block : list.blocks)
    EXPECT_EQ(block.scenes, std::vector<std::string>{"ball"});
  const Spec stand_ins = with_overlay("[preview]\nscenes = { forest = 'small_ball.toml' }\n");
  EXPECT_EQ(stand_ins.blocks[0].scenes, std::vector<std::string>{"small_ball.toml"});
  EXPECT_EQ(stand_ins.blocks[1].scenes, (std::vector<std::string>{"small_ball.toml", "ball"}));
}

TEST(Preview, ComplaintsNameTheLineOfTheOverlay) {
  const auto error = [](const std::string& overlay, Extent extent = Extent::preview) {
    return input_error([&] { with_overlay(overlay, extent); });
  };
  EXPECT_EQ(error(""), "s.toml:1:1: the spec has no [preview]");
  EXPECT_EQ(error("[preview]\nsize = ['1x1']\n"), "s.toml:26:1: unknown key 'size' in preview; did you mean 'sizes'?");
  EXPECT_EQ(error("[preview]\nomit = ['d']\n").substr(0, 32), "s.toml:26:9: unknown block 'd'; ");
  EXPECT_EQ(error("[preview.axes]\nslices = [1]\n"), "s.toml:26:10: no block of the spec has the axis slices");
  EXPECT_EQ(error("[preview.axes]\nscene.size = [1]\n"), "s.toml:26:14: no block of the spec has the axis scene.size");
  EXPECT_EQ(error("[preview.run]\nd.sizes = ['1x1']\n").substr(0, 13), "s.toml:26:1: ");
  EXPECT_EQ(error("[preview.scenes]\nhill = 'ball'\n"), "s.toml:26:8: no block of the spec has the scene 'hill'");
  // Found by the reader of the spec, in what was moved there.
  EXPECT_EQ(error("[preview]\nsizes = ['0x1']\n").substr(0, 15), "s.toml:26:10: s");
  EXPECT_EQ(error("[preview.axes]\nsamples = [1, true]\n").substr(0, 14), "s.toml:26:15: ");
  EXPECT_EQ(error("[preview.scenes]\nforest = 'wood'\n").substr(0, 13), "s.toml:26:10:");
  // A mistake in the preview shows when the full spec is read.
  EXPECT_EQ(error("[preview]\nsizes = ['0x1']\n", Extent::full).substr(0, 15), "s.toml:26:10: s");
}

TEST(Preview, EveryBuiltInSpecHasOneUnderItsName) {
  const std::vector<std::string> names = list_specs();
  for (const std::string& name : names) {
    if (name.ends_with("_preview")) continue;
    const std::string preview = name + "_preview";
    ASSERT_NE(std::find(names.begin(), names.end(), preview), names.end());
    EXPECT_EQ(load_spec(preview).name, preview);
    EXPECT_EQ(load_spec(name, installed_names(), Extent::preview).name, preview);
    EXPECT_FALSE(make_plan(load_spec(preview)).points.empty());
  }
}

}  // namespace
}  // namespace pellucid::sweeps
