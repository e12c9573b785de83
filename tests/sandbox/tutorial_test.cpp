// The tutorial's files do what the tutorial says (sweeps/tutorial/README.md).
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/sandbox/program.hpp"

namespace pellucid::test {
namespace {

using nlohmann::json;

TEST(Tutorial, ItsSweepFillsItsTables) {
  const TemporaryFolder folder;
  const std::string store = (folder / "ball.db").string(), tutorial = PELLUCID_SOURCE_DIR "/sweeps/tutorial/";
  ASSERT_TRUE(succeeded(pellucid({"sweep", "run", tutorial + "ball_sweep.toml", "--store", store, "--quiet"})));

  // Everything in a row is a parameter or a declared quantity.
  std::set<std::string> known;
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"list", "quantities"}, {"describe", "sampling_hulls"}, {"describe", "ray_marching"}}) {
    std::vector<std::string> words = command;
    words.emplace_back("--json");
    const json answer = json::parse(pellucid(words).out);
    for (const json& named : answer.is_array() ? answer : answer.at("parameters"))
      known.insert(named.at("name").get<std::string>());
  }
  for (const json& row : json::parse(pellucid({"results", store, "--format", "json"}).out)) {
    for (const auto& [field, value] : row.items())
      EXPECT_TRUE(known.contains(field) || field.find('.') != std::string::npos) << field;
  }

  const Outcome counts = pellucid({"table", tutorial + "ball.toml:counts", "--store", store, "--json"});
  ASSERT_TRUE(succeeded(counts));
  const json records = json::parse(counts.out);
  ASSERT_EQ(records.size(), 6U);
  for (const json& record : records) {
    EXPECT_EQ(record.at("ours"), record.at("hulls").get<double>() * record.at("samples").get<double>());
    EXPECT_GT(record.at("fps"), 0.0);
    EXPECT_GT(record.at("flip_mean"), 0.0);
  }
  const Outcome equal = pellucid({"table", tutorial + "ball.toml:equal", "--store", store, "--json"});
  ASSERT_TRUE(succeeded(equal));
  const json ratios = json::parse(equal.out);
  ASSERT_EQ(ratios.size(), 4U);
  for (const json& record : ratios) {
    const double ratio = record.at("flip_mean").get<double>() / record.at("flip_mean_marching").get<double>();
    EXPECT_NEAR(record.at("flip_ratio").get<double>(), ratio, 1e-12);
  }
  const Outcome latex = pellucid(
      {"table", tutorial + "ball.toml:counts", "--store", store, "--format", "latex", "--siunitx", "--bold-best"});
  ASSERT_TRUE(succeeded(latex));
  EXPECT_NE(latex.out.find("\\bfseries "), std::string::npos) << latex.out;
  EXPECT_TRUE(refused(pellucid({"table", tutorial + "ball.toml", "--store", store}), 2, {"counts, equal"}));
  EXPECT_TRUE(refused(pellucid({"table", tutorial + "ball.toml:count", "--store", store}), 2, {"'counts'"}));
}

TEST(Tutorial, AMistakeIsAnsweredWithItsPlace) {
  const TemporaryFolder folder;
  const auto path = folder / "mine.toml";
  std::ofstream(path) << "title = \"Mine\"\nsweeps = [\"geocube_table2\"]\n[tables.t]\ntitle = \"x\"\n"
                         "columns = [{ block = \"head\" }]\nrows = [{ show = \"name\" }, { quantity = \"fsp\" }]\n";
  EXPECT_TRUE(refused(pellucid({"table", path.string() + ":t"}), 2, {"mine.toml:6:41: ", "unknown quantity 'fsp'"}));
}

}  // namespace
}  // namespace pellucid::test
