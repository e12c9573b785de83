#include "plots/figures.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "sweeps/spec.hpp"
#include "tests/temporary_folder.hpp"

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

std::string message(auto&& f) {
  try {
    f();
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

class Figures : public testing::Test {
 protected:
  std::string draw(const std::string& name, const std::vector<json>& from) {
    write_figure(name, from, folder_ / (name + ".svg"));
    return test::read_file(folder_ / (name + ".svg"));
  }
  test::TemporaryFolder folder_;
};

TEST_F(Figures, AllAreDrawnFromOneStore) {
  for (const FigureInfo& figure : figures()) {
    if (!figure.name.starts_with("sampling_hulls.")) continue;  // the others: row_figures_test.cpp
    const std::string svg = draw(figure.name, rows());
    EXPECT_NE(svg.find("<svg"), std::string::npos) << figure.name;
    EXPECT_GT(svg.size(), 2000U) << figure.name;
    EXPECT_FALSE(figure.doc.empty());
    EXPECT_EQ(find_figure(figure.name).title, figure.title);
  }
}

TEST_F(Figures, NameSpecsThatExist) {
  for (const FigureInfo& figure : figures())
    EXPECT_NO_THROW(sweeps::load_spec(figure.spec)) << figure.name;
}

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
  const std::string words = message([&] { draw("sampling_hulls.error_time", mixed); });
  EXPECT_NE(words.find("renderer A"), std::string::npos) << words;
  EXPECT_NE(words.find("renderer B"), std::string::npos) << words;
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
  EXPECT_NE(message([&] { draw("sampling_hulls.error", {some.back()}); }), "no error");
}

TEST_F(Figures, UnknownNameSuggestsTheNearest) {
  EXPECT_NE(message([] { find_figure("sampling_hulls.eror"); }).find("sampling_hulls.error"), std::string::npos);
}

}  // namespace
}  // namespace pellucid::plots
