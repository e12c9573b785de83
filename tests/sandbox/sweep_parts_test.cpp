// pellucid sweep run --shard, merge, compare, tune, slurm, references; results --where, --columns.
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tests/sandbox/program.hpp"

namespace pellucid::test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

/// Slices of a small scene; what a point costs and how far it is off both follow from their number.
class SweepParts : public testing::Test {
 protected:
  TemporaryFolder folder;
  std::string scene = write_small_scene(folder).string();
  std::string spec = write_file(folder / "parts.toml", R"(name = "parts"
metrics = ["rmse"]
[timing]
min_samples = 6
max_samples = 6
max_seconds = 2
[reference]
tolerance = 1e-3
[[run]]
name = "slices"
techniques = ["volume_slices"]
scenes = [")" + scene + R"("]
sizes = ["48x36"]
[run.axes]
slices = { from = 2, to = 32, steps = 11 }
)")
                         .string();

  std::string store(const std::string& name) const { return (folder / name).string(); }
  Outcome sweep(const std::string& name, const Words& more = {}) const {
    Words words{"sweep", "run", spec, "--store", store(name), "--references", store("references"), "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return pellucid(words);
  }
  json rows(const std::string& name, const Words& more = {}) const {
    Words words{"results", store(name), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = pellucid(words);
    EXPECT_TRUE(succeeded(outcome));
    return outcome.status == 0 ? json::parse(outcome.out) : json::array();
  }
};

TEST_F(SweepParts, AreMergedToTheWhole) {
  ASSERT_TRUE(succeeded(pellucid({"sweep", "references", spec, "--references", store("references"), "--quiet"})));
  ASSERT_TRUE(succeeded(sweep("whole.db")));
  for (const char* part : {"1", "2", "3"})
    ASSERT_TRUE(succeeded(sweep(std::string("part") + part + ".db", {"--shard", std::string(part) + "/3"})));
  const Outcome merged =
      pellucid({"sweep", "merge", store("all.db"), store("part3.db"), store("part1.db"), store("part2.db"), "--json"});
  ASSERT_TRUE(succeeded(merged));
  EXPECT_EQ(json::parse(merged.out).at("rows"), 11);
  std::map<std::string, json> expected;
  for (const json& row : rows("whole.db"))
    expected[row.at("point")] = row.at("rmse");
  ASSERT_EQ(expected.size(), 11U);
  for (const json& row : rows("all.db"))
    EXPECT_EQ(row.at("rmse"), expected.at(row.at("point")));

  // The same points twice on the same machine: quality is the same to the last bit.
  const Outcome compared = pellucid({"sweep", "compare", store("whole.db"), store("all.db"), "--json"});
  ASSERT_TRUE(compared.status == 0 || compared.status == 3) << compared.err;
  const json counts = json::parse(compared.out).at("counts");
  EXPECT_EQ(counts.at("same_quality"), 11);
  EXPECT_EQ(counts.at("better").get<int>() + counts.at("worse").get<int>(), 0);
  EXPECT_TRUE(refused(pellucid({"sweep", "compare", store("whole.db")}), 2, {"two stores"}));
  EXPECT_TRUE(refused(sweep("x.db", {"--shard", "4/3"}), 2, {"4/3", "i/N"}));
}

TEST_F(SweepParts, AreChosenByTheirFields) {
  ASSERT_TRUE(succeeded(sweep("s.db")));
  const json few = rows("s.db", {"--where", "slices>=20", "--where", "slices<30", "--columns", "slices,rmse"});
  ASSERT_EQ(few.size(), 4U);
  EXPECT_EQ(few[0].size(), 2U);
  EXPECT_EQ(few[0].at("slices"), 20);
  const Outcome lines =
      pellucid({"results", store("s.db"), "--format", "jsonl", "--samples", "--columns", "slices,frame_ms_samples"});
  ASSERT_TRUE(succeeded(lines));
  std::istringstream text(lines.out);
  int count = 0;
  for (std::string line; std::getline(text, line); ++count)
    EXPECT_EQ(json::parse(line).at("frame_ms_samples").size(), 6U);
  EXPECT_EQ(count, 11);
  const Outcome csv = pellucid({"results", store("s.db"), "--columns", "slices,width"});
  EXPECT_EQ(csv.out.substr(0, 14), "slices,width\r\n");
  EXPECT_TRUE(
      refused(pellucid({"results", store("s.db"), "--where", "slice=4"}), 2, {"slice", "did you mean 'slices'"}));
  const Outcome status = pellucid({"sweep", "status", store("s.db")});
  EXPECT_NE(status.out.find("% drawing, timing and measuring"), std::string::npos) << status.out;
}

TEST_F(SweepParts, AreTunedToABound) {
  // The error of one setting as the bound: that one is acceptable, and few cheaper ones are.
  ASSERT_TRUE(succeeded(sweep("whole.db")));
  double bound = 0;
  for (const json& row : rows("whole.db")) {
    if (row.at("slices") == 17) bound = row.at("rmse").get<double>();
  }
  ASSERT_GT(bound, 0);
  const Words words{"sweep",      "tune", spec,     "--store", store("tuned.db"), "--references", store("references"),
                    "--quantity", "rmse", "--json", "--quiet", "--cost",          "slices",       "--below"};
  Words possible = words;
  possible.push_back(fmt::format("{}", bound * 1.000001));
  const Outcome outcome = pellucid(possible);
  ASSERT_TRUE(succeeded(outcome));
  const json answer = json::parse(outcome.out).at(0);
  EXPECT_LE(answer.at("measured").get<int>(), 6);
  EXPECT_LE(answer.at("best").at("rmse").get<double>(), bound * 1.000001);
  EXPECT_LE(answer.at("best").at("settings").at("slices").get<int>(), 17);
  EXPECT_GE(answer.at("front").size(), 2U);
  Words impossible = words;
  impossible.push_back("1e-9");
  EXPECT_EQ(pellucid(impossible).status, 1);
  EXPECT_TRUE(refused(pellucid({"sweep", "tune", spec, "--store", store("tuned.db")}), 2, {"--below"}));
}

TEST_F(SweepParts, AreWrittenForSlurm) {
  const Outcome outcome =
      pellucid({"sweep", "slurm", spec, "-o", store("cluster"), "--shards", "4", "--partition", "gpu", "--dry-run"});
  ASSERT_TRUE(succeeded(outcome));
  EXPECT_NE(outcome.out.find("timing.sbatch"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find("quality.sbatch"), std::string::npos) << "all points are timed";
  EXPECT_NE(read_file(store("cluster") + "/timing.sbatch").find("#SBATCH --array=1-4\n"), std::string::npos);
  EXPECT_TRUE(succeeded(pellucid({"sweep", "status", store("cluster")})));
}

}  // namespace
}  // namespace pellucid::test
