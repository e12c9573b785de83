#include "sweeps/measure/measure.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "gl/context.hpp"
#include "gl/error.hpp"
#include "sweeps/store/sqlite.hpp"
#include "sweeps/store/store.hpp"
#include "sweeps/workers/run.hpp"
#include "tests/sweeps/fake_known_names.hpp"
#include "tests/sweeps/fake_worker.hpp"
#include "tests/sweeps/set_clocks.hpp"

// With the real techniques and scenes, on whatever GL there is.
namespace pellucid::sweeps {
namespace {

using nlohmann::json;
using test::TemporaryFolder;

const char* const kRealSpec = R"(
name = "real"
metrics = ["rmse", "psnr", "ssim", "flip"]
[timing]
min_samples = 3
max_samples = 4
[reference]
tolerance = 1e-3
[[run]]
name = "hulls"
techniques = ["sampling_hulls"]
scenes = ["homogeneous_fog"]
sizes = ["48x36"]
baseline = true
[run.axes]
hulls = [1, 3]
scene.density = [0.5, 1.0]
[[run]]
name = "slices"
techniques = ["volume_slices"]
scenes = ["homogeneous_fog"]
sizes = ["64x48"]
timing.enabled = false
[run.fixed]
slices = 7
frame.format = "single"
)";

TEST(Worker, MeasuresWhatTheContractNames) {
  const TemporaryFolder folder;
  const Spec spec = parse_spec(kRealSpec, "real.toml");
  RunOptions options;
  options.worker = test::self({"real-worker"});
  options.quiet = true;
  const SweepSummary summary = run_sweep(spec, folder / "s.db", options);
  EXPECT_EQ(summary.measured, 5U);
  const std::vector<json> rows = read_rows(folder / "s.db", true);
  ASSERT_EQ(rows.size(), 5U);
  for (const json& row : rows) {
    EXPECT_EQ(row.at("status"), "ok") << row.at("failure");
    for (const char* name : {"rmse", "ssim", "flip_mean", "flip_weighted_median", "flip_weighted_q1",
                             "flip_weighted_q3", "flip_max", "reference_step_error_max", "reference_step_error_mean",
                             "prepare_s", "gpu_bytes", "peak_rss_bytes", "wall_s"}) {
      EXPECT_TRUE(row.at(name).is_number()) << name;
    }
    EXPECT_GT(row.at("gpu_bytes"), 0);
    EXPECT_GT(row.at("peak_rss_bytes"), 1 << 20);
    EXPECT_LT(row.at("rmse"), 0.2);
    EXPECT_EQ(row.at("scene_hash").get<std::string>().size(), 64U);
    EXPECT_FALSE(row.at("device").get<std::string>().empty());
    EXPECT_TRUE(row.contains("scene.density"));
  }
  const json& timed = rows[0];
  EXPECT_EQ(timed.at("hulls"), 1);
  EXPECT_GT(timed.at("frame_ms_median"), 0);
  EXPECT_LE(timed.at("frame_ms_ci95_low"), timed.at("frame_ms_median"));
  EXPECT_GE(timed.at("frame_ms_ci95_high"), timed.at("frame_ms_median"));
  EXPECT_EQ(timed.at("frames"), timed.at("frame_ms_samples").size());
  EXPECT_GE(timed.at("frames"), 3);
  EXPECT_LE(timed.at("frames"), 4);
  EXPECT_FALSE(timed.at("pass_ms").empty());
  EXPECT_TRUE(timed.at("baseline_drift").is_number());
  EXPECT_NE(rows[0].at("scene_hash"), rows[1].at("scene_hash"));  // of the scene at these values
  EXPECT_EQ(rows[0].at("scene_hash"), rows[2].at("scene_hash"));

  const Database db(folder / "s.db", Database::Mode::read);
  EXPECT_EQ(db.integer("SELECT count(*) FROM columns WHERE description = ''"), 0) << "every column is explained";
  Statement pass(db, "SELECT unit, description FROM columns WHERE name = 'pass_ms.hulls'");
  ASSERT_TRUE(pass.step());
  EXPECT_EQ(pass.text(0), "ms");
  EXPECT_NE(pass.text(1).find(": hulls"), std::string::npos) << pass.text(1);

  const json& untimed = rows[4];
  EXPECT_EQ(untimed.at("timing"), "off");
  EXPECT_FALSE(untimed.contains("frame_ms_median"));
  EXPECT_EQ(untimed.at("frame.format"), "single");
  EXPECT_EQ(untimed.at("slices"), 7);
  EXPECT_EQ(untimed.at("frame_ms_samples").size(), 0U);
}

class MeasurerTest : public testing::Test {
 protected:
  Point point(std::size_t index) const { return plan.points.at(index); }
  double rmse(Measurer& measurer, const Point& p) { return measurer.measure(p, folder / "references").row.at("rmse"); }
  static Measurer make() {
    return Measurer([](const char*, double) {});
  }
  gl::Context context;
  TemporaryFolder folder;
  Plan plan = make_plan(parse_spec(kRealSpec, "real.toml"));
};

TEST_F(MeasurerTest, APointDoesNotDependOnThoseBefore) {
  std::vector<double> alone;
  for (std::size_t i = 0; i < plan.points.size(); ++i) {
    Measurer fresh = make();
    alone.push_back(rmse(fresh, point(i)));
  }
  EXPECT_NE(alone[0], alone[1]);
  EXPECT_NE(alone[0], alone[2]);
  Measurer shared = make();
  for (const std::size_t i : {3U, 0U, 4U, 1U, 2U, 0U, 3U})
    EXPECT_EQ(rmse(shared, point(i)), alone[i]) << i;
}

TEST_F(MeasurerTest, ADamagedReferenceIsTracedAgain) {
  Measurer first = make();
  const double before = rmse(first, point(0));
  std::size_t files = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder / "references")) {
    std::filesystem::resize_file(file.path(), 500);
    ++files;
  }
  EXPECT_EQ(files, 1U);
  Measurer second = make();
  EXPECT_EQ(rmse(second, point(0)), before);
  for (const auto& file : std::filesystem::directory_iterator(folder / "references"))
    EXPECT_GT(file.file_size(), 500U);
}

// The machine sleeps while a frame is drawn, which takes half a second longer for it.
TEST_F(MeasurerTest, AFrameInWhichTheMachineSleptDoesNotCount) {
  Point p = point(0);
  p.metrics = {};
  p.timing.min_samples = p.timing.max_samples = 300;
  std::thread lid;
  bool slept = false;
  Measurer measurer(
      [&](const char* phase, double) {
        if (std::string(phase) != "timing" || slept) return;
        slept = true;
        lid = std::thread([] {
          std::this_thread::sleep_for(std::chrono::milliseconds(60));
          test::clock_offsets().monotonic_s = 0.5;
          test::clock_offsets().boot_s = 100.5;
        });
      },
      "");
  const Measurement result = measurer.measure(p, folder / "references");
  lid.join();
  EXPECT_NEAR(result.row.at("slept_s").get<double>(), 100, 0.1);
  EXPECT_EQ(result.frame_ms_samples.size(), 300U);
  EXPECT_LT(*std::max_element(result.frame_ms_samples.begin(), result.frame_ms_samples.end()), 400);
  test::clock_offsets().monotonic_s = test::clock_offsets().boot_s = 0;
  EXPECT_FALSE(measurer.measure(p, folder / "references").row.contains("slept_s"));
}

TEST_F(MeasurerTest, GoesOnAfterAPointThatCannotBeMeasured) {
  Measurer measurer = make();
  const double before = rmse(measurer, point(0));
  Point bad = point(0);
  bad.view = "no_such_view";
  EXPECT_THROW(measurer.measure(bad, folder / "references"), InputError);
  EXPECT_EQ(rmse(measurer, point(0)), before);
}

}  // namespace
}  // namespace pellucid::sweeps
