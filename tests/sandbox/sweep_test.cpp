// pellucid sweep run, sweep status, results, table, plot: one small sweep from its spec to its curves.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/sandbox/program.hpp"

namespace pellucid::test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

/// A spec of a point for each of `hulls` and one more, with `samples` frames timed at each.
std::string small_spec(const std::string& scene, const std::string& hulls = "[1, 2, 4]", int samples = 5) {
  return R"(name = "small"
title = "A small sweep"
metrics = ["rmse", "flip"]
timeout_s = 60

[timing]
min_samples = )" +
         std::to_string(samples) + R"(
max_samples = )" +
         std::to_string(samples) + R"(
max_seconds = 2

[reference]
tolerance = 1e-3

[[run]]
name = "hulls"
techniques = ["sampling_hulls"]
scenes = [")" +
         scene + R"("]
sizes = ["48x36"]

[run.axes]
hulls = )" +
         hulls + R"(

[run.fixed]
samples = 2

[[run]]
name = "slices"
techniques = ["volume_slices"]
scenes = [")" +
         scene + R"("]
sizes = ["48x36"]
baseline = true

[run.fixed]
slices = 8
)";
}

class Sweep : public testing::Test {
 protected:
  TemporaryFolder folder;
  std::string scene = write_small_scene(folder).string();
  std::string spec = write_file(folder / "small.toml", small_spec(scene)).string();
  std::string store = (folder / "small.db").string();

  Outcome sweep(const Words& more = {}) const {
    Words words{"sweep", "run", spec, "--store", store};
    words.insert(words.end(), more.begin(), more.end());
    return pellucid(words);
  }
  json rows() const {
    const Outcome outcome = pellucid({"results", store, "--format", "json"});
    EXPECT_TRUE(succeeded(outcome));
    return outcome.status == 0 ? json::parse(outcome.out) : json::array();
  }
};

TEST_F(Sweep, MeasuresEveryPointOnceAndKeepsTheRows) {
  ASSERT_TRUE(succeeded(sweep()));
  const json first = rows();
  ASSERT_EQ(first.size(), 4U);
  std::set<int> hulls;
  for (const json& row : first) {
    EXPECT_EQ(row.at("status"), "ok");
    EXPECT_EQ(row.at("sweep"), "small");
    EXPECT_EQ(row.at("width"), 48);
    EXPECT_GT(row.at("frame_ms_median").get<double>(), 0);
    EXPECT_LE(row.at("frame_ms_ci95_low").get<double>(), row.at("frame_ms_median").get<double>());
    EXPECT_GE(row.at("frame_ms_ci95_high").get<double>(), row.at("frame_ms_median").get<double>());
    EXPECT_NEAR(row.at("fps").get<double>() * row.at("frame_ms_median").get<double>(), 1000.0, 1e-6);
    EXPECT_GE(row.at("rmse").get<double>(), 0);
    EXPECT_GE(row.at("flip_mean").get<double>(), 0);
    EXPECT_LE(row.at("flip_mean").get<double>(), 1);
    EXPECT_GT(row.at("peak_rss_bytes").get<double>(), 0);
    for (const char* field : {"point", "device", "driver", "commit", "scene_hash", "code_hash", "clock", "repeat"})
      EXPECT_FALSE(row.at(field).get<std::string>().empty()) << field;
    if (row.at("technique") == "sampling_hulls") hulls.insert(row.at("hulls").get<int>());
  }
  EXPECT_EQ(hulls, (std::set<int>{1, 2, 4}));

  const Outcome again = sweep();
  ASSERT_TRUE(succeeded(again));
  EXPECT_EQ(rows(), first);
}

TEST_F(Sweep, ARowSaysHowToRepeatItself) {
  ASSERT_TRUE(succeeded(sweep()));
  const json measured = rows();
  ASSERT_FALSE(measured.empty());
  std::string repeat = measured.front().at("repeat").get<std::string>();
  ASSERT_TRUE(repeat.starts_with("pellucid ")) << repeat;
  repeat.replace(0, std::string("pellucid").size(), "'" PELLUCID_PROGRAM "'");
  EXPECT_TRUE(succeeded(run({"sh", "-c", repeat}, {.folder = folder.path()}))) << repeat;
}

TEST_F(Sweep, ADryRunMeasuresNothing) {
  const Outcome outcome = sweep({"--dry-run"});
  ASSERT_TRUE(succeeded(outcome));
  EXPECT_NE((outcome.out + outcome.err).find("4"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(store));
}

TEST_F(Sweep, ADryRunSaysWhatIsLeftOutAndHowLongItMayTake) {
  const std::string text = small_spec(scene, "[1, 2, 4, 8]");
  const std::size_t at = text.find("[run.axes]");
  write_file(spec, text.substr(0, at) + "constraints = [\"hulls < 8\"]\n" + text.substr(at));
  const Outcome before = sweep({"--dry-run"});
  ASSERT_TRUE(succeeded(before));
  EXPECT_NE(before.out.find("left out of block hulls: 1 point, by the constraint 'hulls < 8'"), std::string::npos)
      << before.out;
  EXPECT_NE(before.out.find("4 distinct points, 4 to measure; at most 8 s of timing"), std::string::npos) << before.out;
  EXPECT_EQ(before.out.find("pellucid render"), std::string::npos) << before.out;
  ASSERT_TRUE(succeeded(sweep({"--limit", "1"})));
  const Outcome after = sweep({"--dry-run", "--list"});
  EXPECT_NE(after.out.find("4 distinct points, 3 to measure; about "), std::string::npos) << after.out;
  EXPECT_NE(after.out.find("# stored"), std::string::npos) << after.out;
  EXPECT_TRUE(refused(sweep({"--list"}), 2, {"--list", "--dry-run"}));
}

TEST_F(Sweep, KeepsThePictureOfEachPoint) {
  std::string text = small_spec(scene, "[1]");
  write_file(spec, "keep = \"png\"\n" + text.insert(text.find("baseline = true"), "keep = \"exr\"\n"));
  ASSERT_TRUE(succeeded(sweep()));
  for (const json& row : rows()) {
    const std::string id = row.at("point").get<std::string>();
    const bool exr = row.at("block") == "slices";
    const std::filesystem::path kept = store + ".pictures/" + id + (exr ? ".exr" : ".png");
    EXPECT_TRUE(std::filesystem::exists(kept)) << kept;
    EXPECT_TRUE(succeeded(pellucid({"compare", kept.string(), kept.string()}))) << kept;
  }
}

TEST_F(Sweep, StatusCountsWhatIsDone) {
  ASSERT_EQ(sweep({"--limit", "3"}).signal, 0);
  auto counted = [&](const char* what) {
    const Outcome outcome = pellucid({"sweep", "status", store, "--json"});
    EXPECT_TRUE(succeeded(outcome));
    int sum = 0;
    for (const json& block : json::parse(outcome.out))
      sum += block.at(what).get<int>();
    return sum;
  };
  EXPECT_EQ(counted("planned"), 4);
  EXPECT_EQ(counted("done"), 3);
  EXPECT_EQ(counted("left"), 1);
  ASSERT_TRUE(succeeded(sweep()));
  EXPECT_EQ(counted("done"), 4);
  EXPECT_EQ(counted("failed"), 0);
  const Outcome plain = pellucid({"sweep", "status", store});
  ASSERT_TRUE(succeeded(plain));
  EXPECT_NE(plain.out.find("small"), std::string::npos);
}

TEST_F(Sweep, ResultsComeAsCsvToo) {
  ASSERT_TRUE(succeeded(sweep()));
  const Outcome outcome = pellucid({"results", store, "--format", "csv"});
  ASSERT_TRUE(succeeded(outcome));
  std::istringstream text(outcome.out);
  std::string header, line;
  std::getline(text, header);
  for (const char* column : {"technique", "hulls", "slices", "frame_ms_median", "rmse", "flip_mean"})
    EXPECT_NE(("," + header + ",").find(std::string(",") + column + ","), std::string::npos) << column;
  std::size_t count = 0;
  while (std::getline(text, line))
    ++count;
  EXPECT_EQ(count, 4U);
}

TEST_F(Sweep, PlotsInEveryFormat) {
  ASSERT_TRUE(succeeded(sweep()));
  const std::vector<std::pair<std::string, std::string>> kinds{{"svg", "<"}, {"png", "\x89PNG"}, {"pdf", "%PDF"}};
  for (const auto& [extension, magic] : kinds) {
    const auto figure = folder / ("figure." + extension);
    ASSERT_TRUE(succeeded(pellucid({"plot", store, "-o", figure.string()}))) << extension;
    EXPECT_TRUE(read_file(figure).starts_with(magic)) << extension;
  }
  EXPECT_TRUE(refused(pellucid({"plot", store, "-o", (folder / "figure.gif").string()}), 2, {".svg", ".png", ".pdf"}));
  EXPECT_TRUE(refused(pellucid({"plot", store, "-o", (folder / "none/f.svg").string()}), 1, {"f.svg"}));
}

TEST_F(Sweep, FailuresLeaveTheStoreAsItWas) {
  ASSERT_TRUE(succeeded(sweep()));
  const json before = rows();
  const std::string good = read_file(spec);
  write_file(spec, good + "\n[run.axs]\n");
  EXPECT_TRUE(refused(sweep(), 2, {"small.toml:"}));
  write_file(spec, small_spec(scene, "[1, 99]"));
  EXPECT_TRUE(refused(sweep(), 2, {"small.toml:", "hulls", "[1, 64]"}));
  write_file(spec, good);
  EXPECT_TRUE(refused(pellucid({"table", "sampling_hulls.table9", "--store", store}), 2, {"sampling_hulls.table1"}));
  EXPECT_TRUE(refused(pellucid({"results", store, "--format", "xml"}), 2, {"xml"}));
  EXPECT_EQ(rows(), before);
}

TEST_F(Sweep, SpecErrorsNameFileLineAndColumn) {
  const std::string good = read_file(spec);
  // The spec with `by` in place of the first `what` is refused, with the place of `pointed` in it and `parts`.
  auto refuses = [&](const std::string& what, const std::string& by, const std::string& pointed, Words parts) {
    std::string text = good;
    const std::size_t begin = text.find(what);
    if (begin == std::string::npos) return testing::AssertionFailure() << "the spec has no " << what;
    text.replace(begin, what.size(), by);
    const std::size_t at = text.find(pointed, begin);
    const std::size_t line =
        static_cast<std::size_t>(std::count(text.begin(), text.begin() + static_cast<long>(at), '\n'));
    const std::size_t column = at - (text.rfind('\n', at) + 1);
    parts.push_back("small.toml:" + std::to_string(line + 1) + ":" + std::to_string(column + 1) + ": ");
    write_file(spec, text);
    return refused(sweep({"--dry-run"}), 2, parts);
  };
  EXPECT_TRUE(refuses("title = \"A", "title = A", "A small", {}));
  EXPECT_TRUE(refuses("metrics", "metrcs", "metrcs", {"metrcs", "metrics"}));
  EXPECT_TRUE(refuses("\"flip\"", "\"flop\"", "\"flop\"", {"flop", "flip"}));
  EXPECT_TRUE(refuses("hulls = [", "hull = [", "hull", {"'hull'", "'hulls'"}));
  EXPECT_TRUE(refuses("[1, 2, 4]", "[1, 2, 400]", "400", {"hulls", "400", "[1, 64]"}));
  EXPECT_TRUE(refuses("[1, 2, 4]", "[1, \"two\"]", "\"two\"", {"hulls", "two", "integer"}));
  EXPECT_TRUE(refuses("[1, 2, 4]", "[]", "[]", {"hulls"}));
  EXPECT_TRUE(refuses("\"sampling_hulls\"", "\"sampling_hull\"", "\"sampling_hull\"", {"'sampling_hulls'"}));
  EXPECT_TRUE(refuses("\"48x36\"", "\"100000x100000\"", "\"100000x100000\"", {"100000x100000"}));
  EXPECT_TRUE(refuses("timeout_s = 60", "timeout_s = \"60\"", "\"60\"", {"timeout_s"}));
  write_file(spec, "");
  EXPECT_TRUE(refused(sweep({"--dry-run"}), 2, {"small.toml"}));
  EXPECT_FALSE(std::filesystem::exists(store));
}

TEST_F(Sweep, RefusesStoresThatAreNone) {
  const auto text =
      write_file(folder / "text.db", "not a store, but long enough to be looked at: " + std::string(2000, 'x'));
  const std::string before = read_file(text);
  EXPECT_TRUE(refused(pellucid({"results", text.string()}), 2, {"text.db"}));
  EXPECT_TRUE(refused(pellucid({"sweep", "status", text.string()}), 2, {"text.db"}));
  EXPECT_TRUE(refused(pellucid({"sweep", "run", spec, "--store", text.string()}), 2, {"text.db"}));
  EXPECT_TRUE(refused(pellucid({"plot", text.string(), "-o", (folder / "f.svg").string()}), 2, {"text.db"}));
  EXPECT_EQ(read_file(text), before);
  const std::string missing = (folder / "missing.db").string();
  EXPECT_TRUE(refused(pellucid({"results", missing}), 2, {"missing.db"}));
  EXPECT_TRUE(refused(pellucid({"sweep", "status", missing}), 2, {"missing.db"}));
  EXPECT_FALSE(std::filesystem::exists(missing));
  EXPECT_TRUE(refused(pellucid({"sweep", "run", spec, "--store", (text / "below.db").string()}), 1, {"text.db"}));
  EXPECT_TRUE(refused(pellucid({"sweep", "run", spec, "--store", "/proc/sweep.db"}), 1, {"/proc/sweep.db"}));
  EXPECT_TRUE(refused(pellucid({"sweep", "run", spec}), 2, {"--store"}));
  EXPECT_TRUE(refused(pellucid({"sweep", "run", "sampling_hulls_tabel1", "--store", store, "--dry-run"}), 2,
                      {"sampling_hulls_table1"}));
}

TEST_F(Sweep, TablesNeedTheirPointsAndSayHowToGetThem) {
  const Outcome unknown = pellucid({"table", "sampling_hulls.tabel1"});
  EXPECT_TRUE(refused(unknown, 2, {"sampling_hulls.table1"}));
  // The small sweep has none of the table's points: each cell is empty or the table says what is missing.
  ASSERT_TRUE(succeeded(sweep()));
  const Outcome outcome = pellucid({"table", "sampling_hulls.table1", "--store", store, "--format", "json"});
  if (outcome.status == 0) {
    for (const json& row : json::parse(outcome.out))
      EXPECT_TRUE(row.at("ours").is_null()) << row;
  } else {
    EXPECT_TRUE(refused(outcome, 2, {"sampling_hulls"}));
  }
}

TEST(Reproduce, RefusesWhatItDoesNotKnow) {
  const TemporaryFolder folder;
  const std::string out = (folder / "results").string();
  EXPECT_TRUE(refused(pellucid({"reproduce", "sampling_huls", "--preview", "-o", out}), 2, {"sampling_hulls"}));
  EXPECT_TRUE(refused(pellucid({"reproduce", (folder / "none.exr").string(), "-o", out}), 2, {"none.exr"}));
  EXPECT_FALSE(std::filesystem::exists(out));
  const auto file = write_file(folder / "file", "");
  EXPECT_TRUE(refused(pellucid({"reproduce", "sampling_hulls", "--preview", "-o", (file / "results").string()}), 1,
                      {"results"}));
}

}  // namespace
}  // namespace pellucid::test
