// A chart shows these of a store's rows: chosen, grouped, never pooled.
#include "plots/figures/rows.hpp"

#include <initializer_list>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "plots/figures/figures.hpp"
#include "plots/figures/row_chart.hpp"
#include "tests/input_error.hpp"

namespace pellucid::plots {
namespace {

using nlohmann::json;

json row(const std::string& technique, json parameters) {
  json out{{"technique", technique}, {"scene", "box"},        {"view", "front"},   {"width", 64},
           {"height", 48},           {"status", "ok"},        {"fps", 20.0},       {"frame_ms_median", 50.0},
           {"flip_mean", 0.1},       {"timing", "converged"}, {"clock", "finish"}, {"device", "A"},
           {"driver", "1"},          {"sweep", "s"},          {"block", "b"}};
  out.update(parameters);
  out["point"] = out.dump();
  return out;
}

bool says(const std::string& words, std::initializer_list<const char*> parts) {
  for (const char* part : parts) {
    if (words.find(part) == std::string::npos) {
      ADD_FAILURE() << "'" << part << "' is not in: " << words;
      return false;
    }
  }
  return true;
}

std::vector<json> slices() {
  std::vector<json> rows;
  for (const char* format : {"half", "single"}) {
    for (int count : {4, 8, 16})
      rows.push_back(row("volume_slices", {{"slices", count}, {"frame.format", format}, {"fps", 400.0 / count}}));
  }
  return rows;
}

const std::vector<std::string> kFps{"fps"};

std::string one_line_error(auto&& f) {
  const std::string message = test::input_error(f);
  EXPECT_EQ(message.find('\n'), std::string::npos) << "more than one line";
  return message;
}

TEST(Rows, AreCountedByWhyTheyAreLeftOut) {
  std::vector<json> rows = slices();
  rows[0]["status"] = "failed";
  rows[1]["timing"] = "off";
  rows[1].erase("fps");
  rows[2]["fps"] = nullptr;
  rows[3]["timing"] = "unconverged";
  rows.push_back(rows[4]);  // the same point in another block
  rows.back()["block"] = "c";
  const Rows chosen = choose_rows(rows, {}, kFps);
  EXPECT_EQ(chosen.failed, 1U);
  EXPECT_EQ(chosen.untimed, 1U);
  EXPECT_EQ(chosen.incomplete, 1U);
  EXPECT_EQ(chosen.unconverged, 1U);
  EXPECT_EQ(chosen.kept.size(), 3U);
  const std::string note = provenance_note(chosen, true);
  says(note, {"box", "64×48", "1 failed point left out", "1 point measured without timing", "1 frame time did not"});
}

TEST(Rows, OfOtherTechniquesDoNotCountAsIncomplete) {
  std::vector<json> rows = slices();
  rows.push_back(row("sampling_hulls", {{"hulls", 4}, {"samples", 8}, {"frame.format", "half"}}));
  const std::vector<std::string> fields{"slices", "fps"};
  const Rows chosen = choose_rows(rows, {}, fields);
  EXPECT_EQ(chosen.kept.size(), 6U);
  EXPECT_EQ(chosen.incomplete, 0U);
}

TEST(Rows, ConditionsCompareNumbersByValueAndTextAsText) {
  const auto count = [&](std::vector<Where> conditions) { return choose_rows(slices(), conditions, {}).kept.size(); };
  EXPECT_EQ(count({{"slices", {"8.0"}}}), 2U);
  EXPECT_EQ(count({{"slices", {"8"}}, {"frame.format", {"single"}}}), 1U);
  says(one_line_error([&] { count({{"slices", {"9"}}}); }), {"slices = 9", "'4'", "'8'", "'16'"});
  says(one_line_error([&] { count({{"slises", {"8"}}}); }), {"slises", "'slices'"});
}

TEST(Rows, OfSeveralDriversAreRefused) {
  std::vector<json> rows = slices();
  rows.back()["driver"] = "2";
  says(one_line_error([&] { choose_rows(rows, {}, kFps); }), {"driver", "'1'", "'2'"});
  const std::vector<Where> one{{"driver", {"2"}}};
  EXPECT_EQ(choose_rows(rows, one, kFps).kept.size(), 1U);
}

TEST(Rows, GroupsNameWhatDiffers) {
  std::vector<json> rows = slices();
  rows.push_back(row("sampling_hulls", {{"hulls", 4}, {"samples", 8}, {"frame.format", "half"}}));
  const Rows chosen = choose_rows(rows, {}, kFps);
  const std::vector<std::string> own{"slices", "hulls", "samples"};
  const auto labels = [&](Labels style) {
    std::vector<std::string> result;
    for (const Group& group : group_rows(chosen, own, style))
      result.push_back(group.label);
    return result;
  };
  EXPECT_EQ(labels(Labels::all),
            (std::vector<std::string>{"volume slices, frame.format = half", "volume slices, frame.format = single",
                                      "sampling hulls, frame.format = half"}));
  EXPECT_EQ(labels(Labels::unusual),
            (std::vector<std::string>{"volume slices", "volume slices, frame.format = single", "sampling hulls"}));
  EXPECT_EQ(usual_note(chosen, own), "Unless named: frame.format half.");
  EXPECT_EQ(group_rows(chosen, own)[1].variant, 1U);
}

TEST(Rows, MeasuredTwiceAreNeverPooled) {
  std::vector<json> rows = slices();
  rows.push_back(rows[0]);
  rows.back()["point"] = "again";
  says(one_line_error([&] { draw_figure(find_figure("sampling_hulls.error"), rows); }), {"slices = 4", "again"});
  says(one_line_error([&] { chart_of_rows(rows, {.x = {.field = "slices"}, .y = {.field = "fps"}}); }),
       {"slices = 4", "frame.format = half"});
}

TEST(RowChart, ChoosesAxesThatShowSomething) {
  const Chart chart = chart_of_rows(slices(), {});
  EXPECT_EQ(chart.x.label, "slices");
  EXPECT_EQ(chart.x.scale, Scale::log2);
  EXPECT_EQ(chart.y.label, "frame rate");
  ASSERT_EQ(chart.series.size(), 2U);
  ASSERT_EQ(chart.series[0].points.size(), 3U);
  EXPECT_EQ(chart.series[0].points[1].x, 8);
  EXPECT_EQ(chart.series[0].points[1].y, 50);
  EXPECT_FALSE(chart.series[0].style.color == chart.series[1].style.color);
}

TEST(RowChart, AsksForWhatItCannotDecide) {
  says(one_line_error(
           [] { chart_of_rows(slices(), {.x = {.field = "slices"}, .y = {.field = "fps"}, .series = {"technique"}}); }),
       {"slices = 4", "frame.format = single", "--series", "--where"});
  says(one_line_error([] { chart_of_rows(slices(), {.x = {.field = "slices"}, .y = {.field = "fsp"}}); }),
       {"'fsp'", "'fps'"});
  says(one_line_error(
           [] { chart_of_rows(slices(), {.x = {.field = "slices"}, .y = {.field = "fps"}, .series = {"colour"}}); }),
       {"colour"});
  says(one_line_error([] { chart_of_rows({}, {}); }), {"no rows"});
  EXPECT_EQ(
      chart_of_rows(slices(), {.x = {.field = "slices"}, .y = {.field = "fps"}, .where = {{"frame.format", {"half"}}}})
          .series.size(),
      1U);
}

}  // namespace
}  // namespace pellucid::plots
