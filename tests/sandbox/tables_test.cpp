// pellucid table, and results' less usual ends.
#include <string>

#include <nlohmann/json.hpp>

#include "tests/sandbox/program.hpp"

namespace pellucid::test {
namespace {

using nlohmann::json;

constexpr const char* kTable = "sampling_hulls.table1";

TEST(TableCommand, ShowsThePapersNumbersWithoutAStoreAndSaysHowToGetOurs) {
  const Outcome outcome = pellucid({"table", kTable});
  ASSERT_TRUE(succeeded(outcome));
  EXPECT_NE(outcome.out.find("| fps (paper) "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.err.find("pellucid sweep run sampling_hulls_table1 --store S.db"), std::string::npos)
      << outcome.err;
}

TEST(TableCommand, GivesEveryFormat) {
  const Outcome csv = pellucid({"table", kTable, "--format", "csv"});
  ASSERT_TRUE(succeeded(csv));
  EXPECT_TRUE(csv.out.starts_with("Number of hulls,1,2,4,8,16,32\r\n")) << csv.out;
  const Outcome latex = pellucid({"table", kTable, "--format", "latex"});
  ASSERT_TRUE(succeeded(latex));
  EXPECT_NE(latex.out.find("\\toprule"), std::string::npos) << latex.out;
  const Outcome flag = pellucid({"table", kTable, "--json"});
  ASSERT_TRUE(succeeded(flag));
  EXPECT_EQ(json::parse(flag.out).size(), 6U);
  EXPECT_EQ(flag.out, pellucid({"table", kTable, "--format", "json"}).out);
  EXPECT_TRUE(refused(pellucid({"table", kTable, "--format", "html"}), 2, {"html"}));
}

TEST(TableCommand, WritesAFile) {
  const TemporaryFolder folder;
  const auto path = folder / "table.md";
  const Outcome outcome = pellucid({"table", kTable, "-o", path.string()});
  ASSERT_TRUE(succeeded(outcome));
  EXPECT_TRUE(outcome.out.empty()) << outcome.out;
  EXPECT_EQ(read_file(path), pellucid({"table", kTable}).out);
  EXPECT_TRUE(refused(pellucid({"table", kTable, "-o", (folder / "none/table.md").string()}), 1, {"none/table.md"}));
}

TEST(TableCommand, RefusesWhatCannotBe) {
  const TemporaryFolder folder;
  EXPECT_TRUE(refused(pellucid({"table", "sampling_huls.table1"}), 2, {kTable}));
  EXPECT_TRUE(refused(pellucid({"table", kTable, "--store", (folder / "none.db").string()}), 2, {"none.db"}));
  EXPECT_TRUE(refused(pellucid({"table", kTable, "--device-name", "GPU"}), 2, {"--store"}));
  EXPECT_TRUE(refused(pellucid({"table"}), 2, {"name"}));
}

TEST(TableCommand, HelpListsTheTables) {
  const Outcome outcome = pellucid({"table", "--help"});
  ASSERT_TRUE(succeeded(outcome));
  for (const char* part : {kTable, "Imagire et al. 2007, Table 1", "Examples:"})
    EXPECT_NE(outcome.out.find(part), std::string::npos) << outcome.out;
}

TEST(TableCommand, AFullDiskIsAnError) {
  const Outcome outcome = run({"sh", "-c", "'" PELLUCID_PROGRAM "' table sampling_hulls.table1 > /dev/full"});
  EXPECT_TRUE(refused(outcome, 1, {"standard output"}));
}

/// The built-in spec's name with a sweep of a few pixels: its rows fill the table.
TEST(TableCommand, FillsItselfFromAStore) {
  const TemporaryFolder folder;
  const auto scene = write_small_scene(folder);
  const auto spec = write_file(folder / "table1.toml", R"(name = "sampling_hulls_table1"
title = "Table 1, tiny"
metrics = ["flip", "rmse"]
[timing]
min_samples = 3
max_samples = 3
max_seconds = 2
[reference]
tolerance = 1e-3
[[run]]
name = "table1"
techniques = ["sampling_hulls"]
scenes = [")" + scene.string() + R"("]
sizes = ["48x36"]
combine = "zip"
[run.axes]
hulls = [1, 4]
samples = [32, 8]
)");
  const std::string store = (folder / "table1.db").string();
  ASSERT_TRUE(succeeded(pellucid({"sweep", "run", spec.string(), "--store", store})));
  const Outcome outcome = pellucid({"table", kTable, "--store", store, "--format", "json"});
  ASSERT_TRUE(succeeded(outcome));
  const json rows = json::parse(outcome.out);
  ASSERT_EQ(rows.size(), 6U);
  for (const json& row : rows) {
    const bool measured = row.at("hulls") == 1 || row.at("hulls") == 4;
    EXPECT_EQ(row.at("ours").is_number(), measured) << row;
    EXPECT_EQ(row.at("rmse").is_number(), measured) << row;
    EXPECT_EQ(row.at("flip_mean").is_number(), measured) << row;
    if (!measured) continue;
    EXPECT_GT(row.at("ours").get<double>(), 0);
    EXPECT_LE(row.at("ours_ci95_low").get<double>(), row.at("ours").get<double>());
    EXPECT_GE(row.at("ours_ci95_high").get<double>(), row.at("ours").get<double>());
  }
  EXPECT_EQ(rows[2].at("ours_relative_to_4x8"), 1.0);
  EXPECT_NE(outcome.err.find("note: Not measured yet: 2 × 16, 8 × 4"), std::string::npos) << outcome.err;
  const std::string device = rows[0].at("device").get<std::string>();
  EXPECT_TRUE(succeeded(pellucid({"table", kTable, "--store", store, "--device-name", device})));
  EXPECT_TRUE(refused(pellucid({"table", kTable, "--store", store, "--device-name", "none such"}), 2, {device}));
}

TEST(ResultsCommand, NeedsAStoreThatIsThere) {
  const TemporaryFolder folder;
  EXPECT_TRUE(refused(pellucid({"results"}), 2, {"store"}));
  EXPECT_TRUE(refused(pellucid({"results", (folder / "none.db").string(), "--json"}), 2, {"none.db"}));
}

}  // namespace
}  // namespace pellucid::test
