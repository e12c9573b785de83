#include "plots/figures/figures.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "tests/input_error.hpp"

namespace pellucid::plots {
namespace {

using nlohmann::json;

json row(const std::string& technique, json parameters, double ms, double flip) {
  json out{{"point", technique + parameters.dump()},
           {"sweep", "test"},
           {"block", technique},
           {"technique", technique},
           {"scene", "fog_forest"},
           {"view", "path"},
           {"width", 720},
           {"height", 540},
           {"status", "ok"},
           {"frame_ms_median", ms},
           {"frame_ms_ci95_low", ms * 0.99},
           {"frame_ms_ci95_high", ms * 1.01},
           {"frame_ms_q25", ms * 0.98},
           {"frame_ms_q75", ms * 1.02},
           {"fps", 1000 / ms},
           {"frames", 30},
           {"timing", "converged"},
           {"clock", "finish"},
           {"prepare_s", 0.1},
           {"flip_mean", flip},
           {"flip_weighted_median", flip},
           {"flip_weighted_q1", flip / 2},
           {"flip_weighted_q3", flip * 2},
           {"rmse", flip / 5},
           {"device", "renderer A"},
           {"driver", "driver 1"},
           {"commit", "0"},
           {"dirty", false}};
  out.update(parameters);
  return out;
}

std::vector<json> rows() {
  std::vector<json> all;
  for (int hulls : {1, 2, 4, 8}) {
    for (int samples : {1, 2, 4, 8}) {
      all.push_back(row("sampling_hulls", {{"hulls", hulls}, {"samples", samples}, {"frame.format", "half"}},
                        10 + hulls * samples, 0.5 / (hulls * samples)));
    }
  }
  for (int slices : {4, 8, 16, 32}) {
    all.push_back(row("volume_slices", {{"slices", slices}, {"frame.format", "half"}}, 10 + slices, 1.0 / slices));
  }
  return all;
}

/// Averaging halves the error, a larger map another time; other blocks of the spec lie among them.
std::vector<json> shadow_rows() {
  std::vector<json> all;
  for (const char* figure : {"fig10", "fig11"}) {
    const auto add = [&](const char* technique, const char* part, json parameters, double flip) {
      parameters["of"] = figure;
      all.push_back(row(technique, std::move(parameters), 10, flip));
      all.back().erase("of");
      all.back()["block"] = std::string(figure) + "_" + part;
      all.back()["flip_mean_shadow"] = flip;
    };
    for (const int size : {64, 128, 256}) {
      for (const bool filter : {true, false}) {
        const double flip = (filter ? 3.0 : 6.0) / size;
        add("sampling_hulls", "hulls",
            {{"hulls", 8}, {"samples", 8}, {"filter_occlusion", filter}, {"shadow.size", size}}, flip);
        add("ray_marching", "marching", {{"samples", 64}, {"filter_occlusion", filter}, {"shadow.size", size}}, flip);
      }
      add("volume_slices", "slices", {{"slices", 64}, {"shadow.size", size}}, 8.0 / size);
    }
    add("sampling_hulls", "counts_back",
        {{"hulls", 2}, {"samples", 4}, {"filter_occlusion", true}, {"shadow.size", 256}}, 0.9);
  }
  return all;
}

class Figures : public testing::Test {
 protected:
  std::string draw(const std::string& name, const std::vector<json>& from) {
    return draw_figure(find_figure(name), from).svg;
  }
};

TEST_F(Figures, FollowTheData) {
  std::vector<json> changed = rows();
  changed.front()["flip_mean"] = 0.9;
  EXPECT_NE(draw("sampling_hulls.error", rows()), draw("sampling_hulls.error", changed));
  EXPECT_EQ(draw("sampling_hulls.error", rows()), draw("sampling_hulls.error", rows()))
      << "the same rows, the same file";
}

TEST_F(Figures, DevicesAreNeverPooled) {
  std::vector<json> mixed = rows();
  mixed.back()["device"] = "renderer B";
  const std::string words = test::input_error([&] { draw("sampling_hulls.error_time", mixed); });
  EXPECT_NE(words.find("renderer A"), std::string::npos) << words;
  EXPECT_NE(words.find("renderer B"), std::string::npos) << words;
}

/// The note of a map as one line of words.
std::string note_of(const std::string& svg) {
  std::string text;
  bool tag = false;
  for (const char c : svg) {
    if (c == '<') tag = true;
    if (!tag) text += c == '\n' ? ' ' : c;
    if (c == '>') tag = false;
  }
  return text;
}

TEST_F(Figures, MapsMarkThePapersChoiceAndTheFastestThatErrsNoMore) {
  // FLIP falls with M·N and time grows with it: nothing beats 4×8 = 32 but 8×4, once it is faster.
  std::vector<json> plane = rows();
  for (const char* name : {"sampling_hulls.fps_map", "sampling_hulls.error_map"}) {
    const std::string own = note_of(draw(name, plane));
    EXPECT_NE(own.find("paper"), std::string::npos) << name;
  }
  for (json& row : plane) {
    if (row.value("hulls", 0) != 8 || row.value("samples", 0) != 4) continue;
    row["fps"] = 1000 / 20.0;
    row["frame_ms_median"] = 20.0;
  }
  for (const char* name : {"sampling_hulls.fps_map", "sampling_hulls.error_map"})
    EXPECT_NE(note_of(draw(name, plane)).find("8×4"), std::string::npos) << name;
  // A fast setting that errs more is not taken, whatever its speed.
  for (json& row : plane) {
    if (row.value("hulls", 0) == 1 && row.value("samples", 0) == 1) row["fps"] = 1e6;
  }
  EXPECT_NE(note_of(draw("sampling_hulls.error_map", plane)).find("8×4"), std::string::npos);
  // Without the paper's point there is nothing to hold the others to.
  std::erase_if(plane, [](const json& row) { return row.value("hulls", 0) == 4 && row.value("samples", 0) == 8; });
  EXPECT_EQ(note_of(draw("sampling_hulls.error_map", plane)).find("ours"), std::string::npos);
}

TEST_F(Figures, ShadowChartsTakeTheirOwnFigureAlone) {
  std::vector<json> changed = shadow_rows();
  for (json& row : changed) {
    if (row.at("block") == "fig11_hulls" || row.at("block") == "fig10_counts_back") row["flip_mean_shadow"] = 0.77;
  }
  EXPECT_EQ(draw("sampling_hulls.shadow_error_fig10", shadow_rows()),
            draw("sampling_hulls.shadow_error_fig10", changed));
  EXPECT_NE(draw("sampling_hulls.shadow_error_fig11", shadow_rows()),
            draw("sampling_hulls.shadow_error_fig11", changed));
  EXPECT_NE(test::input_error([&] { draw("sampling_hulls.shadow_error_fig10", rows()); }).find("fig10_hulls"),
            std::string::npos);
}

TEST_F(Figures, FailedRowsAreLeftOutAndCounted) {
  std::vector<json> some = rows();
  some.push_back({{"point", "x"},
                  {"technique", "sampling_hulls"},
                  {"status", "failed"},
                  {"failure", "crash"},
                  {"hulls", 64},
                  {"samples", 1},
                  {"scene", "fog_forest"},
                  {"view", "path"},
                  {"width", 720},
                  {"height", 540},
                  {"device", "renderer A"},
                  {"driver", "driver 1"},
                  {"frame.format", "half"}});
  EXPECT_NE(draw("sampling_hulls.error", some), draw("sampling_hulls.error", rows())) << "the note tells";
  test::input_error([&] { draw("sampling_hulls.error", {some.back()}); });
}

TEST_F(Figures, UnknownNameSuggestsTheNearest) {
  EXPECT_NE(test::input_error([] { find_figure("sampling_hulls.eror"); }).find("sampling_hulls.error"),
            std::string::npos);
}

}  // namespace
}  // namespace pellucid::plots
