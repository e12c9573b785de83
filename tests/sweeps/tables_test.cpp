// The papers' tables: published numbers, ours beside them, and which rows a table takes.
#include "sweeps/tables/tables.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sweeps/spec/plan.hpp"
#include "tests/sweeps/fake_known_names.hpp"
#include "tests/sweeps/table_texts.hpp"

namespace pellucid::sweeps::test {
namespace {

using nlohmann::json;

constexpr const char* kName = "sampling_hulls.table1";

/// A measured row: `frame_ms` in an interval of a tenth of it either side.
json measured(int hulls, int samples, double frame_ms) {
  return {{"sweep", "sampling_hulls_table1"},
          {"block", "table1"},
          {"point", "point of " + std::to_string(hulls)},
          {"technique", "sampling_hulls"},
          {"scene", "fog_forest"},
          {"view", "path"},
          {"width", 720},
          {"height", 540},
          {"hulls", hulls},
          {"samples", samples},
          {"status", "ok"},
          {"failure", ""},
          {"timing", "converged"},
          {"frame_ms_median", frame_ms},
          {"frame_ms_ci95_low", 0.9 * frame_ms},
          {"frame_ms_ci95_high", 1.1 * frame_ms},
          {"fps", 1000 / frame_ms},
          {"frames", 30},
          {"flip_mean", 0.0125},
          {"rmse", 0.00123},
          {"reference_step_error_max", 0.00031},
          {"reference_step_error_mean", 1.2e-6},
          {"baseline_drift", -0.012},
          {"clock", "gpu_query"},
          {"device", "GPU"},
          {"driver", "4.5 A"},
          {"commit", "0123456789abcdef"},
          {"dirty", false}};
}

std::vector<json> all_measured() {
  return {measured(1, 32, 10), measured(2, 16, 8), measured(4, 8, 5),
          measured(8, 4, 6),   measured(16, 2, 7), measured(32, 1, 20)};
}

using Words = std::vector<std::string>;

TEST(Tables, AreFoundByNameOrByTheNearest) {
  ASSERT_FALSE(tables().empty());
  EXPECT_EQ(find_table(kName).spec, "sampling_hulls_table1");
  EXPECT_EQ(find_table(kName).source, "Imagire et al. 2007, Table 1");
  const std::string error = input_error([] { find_table("sampling_hulls.tabel1"); });
  EXPECT_NE(error.find("did you mean 'sampling_hulls.table1'?"), std::string::npos) << error;
  EXPECT_NE(input_error([] { make_table("xyz", {}); }).find(kName), std::string::npos);
}

TEST(Tables, PublishedNumbersStandWithoutAnyOfOurs) {
  const Table table = make_table(kName, {});
  EXPECT_TRUE(table.sweep.empty());
  EXPECT_EQ(texts(table, "Number of hulls"), (Words{"1", "2", "4", "8", "16", "32"}));
  EXPECT_EQ(texts(table, "Number of samples"), (Words{"32", "16", "8", "4", "2", "1"}));
  EXPECT_EQ(texts(table, "fps (paper)"), (Words{"50", "59", "64", "62", "55", "47"}));
  EXPECT_EQ(texts(table, "fps relative to 4 × 8 (paper)"), (Words{"0.78", "0.92", "1.00", "0.97", "0.86", "0.73"}));
  for (const char* ours : {"fps (ours)", "95 % interval", "fps relative to 4 × 8 (ours)", "FLIP", "RMSE"})
    EXPECT_EQ(texts(table, ours), Words(6)) << ours;
  EXPECT_TRUE(noted(table, "GeForce 7800 GTX"));
}

TEST(Tables, OursComeFromTheStoresRows) {
  const Table table = make_table(kName, all_measured());
  EXPECT_EQ(table.sweep, "sampling_hulls_table1");
  EXPECT_EQ(texts(table, "fps (ours)"), (Words{"100.0", "125.0", "200.0", "166.7", "142.9", "50.00"}));
  // The interval's ends change places: the longest frame is the lowest rate.
  EXPECT_EQ(texts(table, "95 % interval")[2], "181.8–222.2");
  EXPECT_DOUBLE_EQ(row_of(table, "95 % interval, low").cells[2].value.value(), 1000 / 5.5);
  EXPECT_DOUBLE_EQ(row_of(table, "95 % interval, high").cells[2].value.value(), 1000 / 4.5);
  EXPECT_EQ(format_table(table, TableFormat::markdown).find("interval, low"), std::string::npos);
  EXPECT_EQ(texts(table, "fps relative to 4 × 8 (ours)"), (Words{"0.50", "0.62", "1.00", "0.83", "0.71", "0.25"}));
  EXPECT_EQ(texts(table, "FLIP"), Words(6, "0.0125"));
  EXPECT_EQ(texts(table, "RMSE"), Words(6, "0.00123"));
  EXPECT_DOUBLE_EQ(row_of(table, "fps (ours)").cells[3].value.value(), 1000.0 / 6);
  EXPECT_TRUE(noted(table, "Ours: GPU, 4.5 A; 720 × 540; timed by queries on the GPU."));
  EXPECT_TRUE(noted(table, "Scene fog_forest, view path: procedural trees"));
  EXPECT_TRUE(noted(table, "30 frames per point"));
  EXPECT_TRUE(noted(table, "step error is at most 0.00031, 1.2e-06 in the mean"));
  EXPECT_TRUE(noted(table, "-1.2 % to -1.2 %"));
  EXPECT_TRUE(noted(table, "Commit 0123456789ab."));
  EXPECT_FALSE(noted(table, "unconverged"));
  EXPECT_FALSE(noted(table, "Not measured"));
}

TEST(Tables, ARandomReferenceTellsItsNoise) {
  std::vector<json> rows = all_measured();
  for (json& row : rows) {
    row["reference_standard_error_max"] = 0.25;
    row["reference_standard_error_mean"] = 0.0125;
  }
  EXPECT_TRUE(noted(make_table(kName, rows),
                    "The reference's own standard error is at most 0.25, 0.013 in the mean; its step error is at most "
                    "0.00031, 1.2e-06 in the mean."));
  for (json& row : rows)
    row["reference_step_error_max"] = 0.0;  // nothing is stepped through
  EXPECT_TRUE(noted(make_table(kName, rows), "own standard error is at most 0.25, 0.013 in the mean."));
}

TEST(Tables, AFailedPointSaysSoAndWhy) {
  std::vector<json> rows = all_measured();
  rows[1] = {{"sweep", "sampling_hulls_table1"},
             {"point", "lost"},
             {"technique", "sampling_hulls"},
             {"hulls", 2},
             {"samples", 16},
             {"status", "failed"},
             {"failure", "killed by signal 11"},
             {"device", ""},
             {"driver", ""}};
  const Table table = make_table(kName, rows);
  for (const char* ours : {"fps (ours)", "95 % interval", "fps relative to 4 × 8 (ours)", "FLIP", "RMSE"}) {
    EXPECT_EQ(texts(table, ours)[1], "failed") << ours;
    EXPECT_FALSE(row_of(table, ours).cells[1].value) << ours;
    EXPECT_NE(texts(table, ours)[0], "failed") << ours;
  }
  EXPECT_TRUE(noted(table, "2 × 16 failed: killed by signal 11"));
}

TEST(Tables, UnconvergedPointsAreMarkedAndCounted) {
  std::vector<json> rows = all_measured();
  rows[0]["timing"] = rows[4]["timing"] = "unconverged";
  const Table table = make_table(kName, rows);
  EXPECT_EQ(texts(table, "fps (ours)"), (Words{"100.0†", "125.0", "200.0", "166.7", "142.9†", "50.00"}));
  EXPECT_EQ(row_of(table, "fps (ours)").cells[0].value, 100.0);
  EXPECT_TRUE(noted(table, "† unconverged, 2 of 6 points"));
  EXPECT_NE(format_table(table, TableFormat::markdown).find("100.0† |"), std::string::npos);
}

TEST(Tables, PointsWithoutTimeOrResultStayEmptyAndAreNamed) {
  std::vector<json> rows = all_measured();
  rows.erase(rows.begin() + 2);  // 4 × 8, which the others are related to
  rows[0]["timing"] = "off";
  for (const char* field : {"fps", "frame_ms_median", "frame_ms_ci95_low", "frame_ms_ci95_high"})
    rows[0].erase(field);
  rows[1]["rmse"] = nullptr;
  const Table table = make_table(kName, rows);
  EXPECT_EQ(texts(table, "fps (ours)"), (Words{"", "125.0", "", "166.7", "142.9", "50.00"}));
  EXPECT_EQ(texts(table, "95 % interval")[0], "");
  EXPECT_EQ(texts(table, "fps relative to 4 × 8 (ours)"), Words(6));
  EXPECT_EQ(texts(table, "RMSE"), (Words{"0.00123", "", "", "0.00123", "0.00123", "0.00123"}));
  EXPECT_TRUE(noted(table, "Measured without timing: 1 × 32."));
  EXPECT_TRUE(noted(table, "Not measured yet: 4 × 8."));
}

TEST(Tables, DevicesAndDriversAreNeverPooled) {
  std::vector<json> rows = all_measured();
  rows[5]["driver"] = "4.6 B";
  const std::string error = input_error([&] { make_table(kName, rows); });
  for (const char* part : {"GPU, 4.5 A", "GPU, 4.6 B", "--device-name"})
    EXPECT_NE(error.find(part), std::string::npos) << error;
  const Table table = make_table(kName, rows, "4.6 B");
  EXPECT_EQ(texts(table, "fps (ours)"), (Words{"", "", "", "", "", "50.00"}));
  EXPECT_TRUE(noted(table, "Ours: GPU, 4.6 B"));
  const std::string none = input_error([&] { make_table(kName, rows, "Radeon"); });
  for (const char* part : {"Radeon", "GPU, 4.5 A", "GPU, 4.6 B"})
    EXPECT_NE(none.find(part), std::string::npos) << none;
}

TEST(Tables, OtherSweepsAreLeftAloneAndThePreviewServesWhereThereIsNoOther) {
  std::vector<json> rows = all_measured();
  json other = measured(4, 8, 1);
  other["sweep"] = "mine";
  other["device"] = "another";
  rows.push_back(other);
  EXPECT_EQ(texts(make_table(kName, rows), "fps (ours)")[2], "200.0");
  EXPECT_TRUE(make_table(kName, {other}).sweep.empty());

  json preview = measured(4, 8, 2);
  preview["sweep"] = "sampling_hulls_table1_preview";
  rows.push_back(preview);
  EXPECT_EQ(texts(make_table(kName, rows), "fps (ours)")[2], "200.0");
  const Table alone = make_table(kName, {preview});
  EXPECT_EQ(texts(alone, "fps (ours)")[2], "500.0");
  EXPECT_EQ(alone.sweep, "sampling_hulls_table1_preview");
  EXPECT_TRUE(noted(alone, "A preview"));
}

TEST(Tables, TwoRowsMayNotClaimOnePlace) {
  std::vector<json> rows = all_measured();
  rows.push_back(rows[2]);  // the same point in a second block
  rows.back()["block"] = "again";
  EXPECT_EQ(texts(make_table(kName, rows), "fps (ours)")[2], "200.0");
  rows.back()["point"] = "another";
  rows.back()["width"] = 360;
  const std::string error = input_error([&] { make_table(kName, rows); });
  for (const char* part : {"hulls = 4, samples = 8", "width", "720", "360"})
    EXPECT_NE(error.find(part), std::string::npos) << error;
}

TEST(PaperSpecs, AllExpand) {
  const std::vector<std::string> names = list_specs();
  for (const char* name : {"sampling_hulls_table1", "sampling_hulls_table1_preview", "sampling_hulls_curves",
                           "sampling_hulls_curves_preview"})
    EXPECT_NE(std::find(names.begin(), names.end(), name), names.end()) << name;
  for (const std::string& name : names) {
    if (lacks_assets(name)) continue;
    const Spec spec = load_spec(name);
    EXPECT_EQ(spec.name, name) << "rows are found by the name of the built-in spec";
    EXPECT_FALSE(spec.title.empty()) << name;
    const Plan plan = make_plan(spec);
    EXPECT_FALSE(plan.points.empty()) << name;
    const bool timed =
        std::any_of(plan.points.begin(), plan.points.end(), [](const Point& point) { return point.timing.enabled; });
    EXPECT_EQ(plan.baseline.has_value(), timed) << name << ": drift shows where times are taken";
  }
  for (const TableInfo& info : tables()) {
    EXPECT_NE(std::find(names.begin(), names.end(), info.spec), names.end()) << info.spec;
    EXPECT_NE(std::find(names.begin(), names.end(), info.spec + "_preview"), names.end()) << info.spec;
  }
}

TEST(PaperSpecs, Table1HasThePapersSixPointsAtThePapersSize) {
  for (const char* name : {"sampling_hulls_table1", "sampling_hulls_table1_preview"}) {
    const Plan plan = make_plan(load_spec(name));
    std::vector<std::pair<std::int64_t, std::int64_t>> points;
    for (const Point& point : plan.points) {
      points.emplace_back(std::get<std::int64_t>(point.parameters.at("hulls")),
                          std::get<std::int64_t>(point.parameters.at("samples")));
      EXPECT_EQ(point.technique, "sampling_hulls");
      EXPECT_EQ(point.scene, "fog_forest");
      EXPECT_EQ(point.size.width, 720);
      EXPECT_EQ(point.size.height, 540);
      EXPECT_EQ(point.metrics, (Words{"flip", "rmse"}));
      EXPECT_TRUE(point.timing.enabled);
      EXPECT_EQ(point.reference.surfaces, ReferenceSurfaces::raster);
      EXPECT_EQ(std::get<std::string>(point.parameters.at("frame.format")), "half");
    }
    EXPECT_EQ(points, (decltype(points){{1, 32}, {2, 16}, {4, 8}, {8, 4}, {16, 2}, {32, 1}})) << name;
  }
}

TEST(PaperSpecs, CurvesHoldThePlaneAndItsRivals) {
  const Plan plan = make_plan(load_spec("sampling_hulls_curves"));
  std::map<std::string, std::size_t> counts;
  for (const Member& member : plan.members) {
    ++counts[member.block];
    const Point& point = plan.points[member.point];
    EXPECT_EQ(point.timing.enabled, !member.block.ends_with("_single")) << member.block;
    if (point.technique != "sampling_hulls") continue;
    EXPECT_LE(
        std::get<std::int64_t>(point.parameters.at("hulls")) * std::get<std::int64_t>(point.parameters.at("samples")),
        128);
  }
  EXPECT_EQ(counts,
            (decltype(counts){
                {"hulls", 30}, {"hulls_single", 30}, {"ray_marching", 7}, {"slices", 9}, {"slices_single", 9}}));
}

}  // namespace
}  // namespace pellucid::sweeps::test
