// pellucid --help, list, describe, devices.
#include <algorithm>
#include <cstddef>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/sandbox/program.hpp"

namespace pellucid::test {
namespace {

using nlohmann::json;

const std::vector<std::vector<std::string>>& subcommands() {
  static const std::vector<std::vector<std::string>> all{
      {"list"},    {"devices"},        {"describe"},         {"render"},        {"reference"},
      {"compare"}, {"sweep", "run"},   {"sweep", "status"},  {"results"},       {"table"},
      {"bench"},   {"plot"},           {"reproduce"},        {"slab"},          {"bundle"},
      {"view"},    {"sweep", "merge"}, {"sweep", "compare"}, {"sweep", "tune"}, {"sweep", "slurm"}};
  return all;
}

std::set<std::string> names(const json& rows) {
  std::set<std::string> out;
  for (const json& row : rows)
    out.insert(row.at("name").get<std::string>());
  return out;
}

TEST(Help, NamesEverySubcommand) {
  const Outcome help = pellucid({"--help"});
  ASSERT_TRUE(succeeded(help));
  EXPECT_EQ(help.err, "");
  for (const auto& words : subcommands())
    EXPECT_NE(help.out.find("\n  " + words.front()), std::string::npos) << words.front();
}

TEST(Help, EverySubcommandShowsAnExample) {
  for (std::vector<std::string> words : subcommands()) {
    std::string name = "pellucid";
    for (const std::string& word : words)
      name += " " + word;
    words.push_back("--help");
    const Outcome help = pellucid(words);
    ASSERT_TRUE(succeeded(help)) << name;
    const std::size_t examples = help.out.find("\nExample");
    ASSERT_NE(examples, std::string::npos) << name << "\n" << help.out;
    EXPECT_NE(help.out.find(name + " ", examples), std::string::npos) << name << "\n" << help.out;
  }
}

TEST(Help, EveryCommandOfTheReadmeExists) {
  const std::string readme = read_file(PELLUCID_SOURCE_DIR "/README.md");
  const std::regex call("^(?:build/release/bin/)?pellucid ([a-z]+)( [a-z]+)?", std::regex::multiline);
  std::set<std::string> known;
  for (const auto& words : subcommands())
    known.insert(words.front());
  std::size_t found = 0;
  for (std::sregex_iterator at(readme.begin(), readme.end(), call), end; at != end; ++at, ++found)
    EXPECT_TRUE(known.contains((*at)[1])) << at->str();
  EXPECT_GE(found, known.size() - 1);
}

TEST(Help, VersionIsOneLine) {
  const Outcome version = pellucid({"--version"});
  ASSERT_TRUE(succeeded(version));
  EXPECT_TRUE(std::regex_match(version.out, std::regex("(pellucid )?\\d+\\.\\d+\\.\\d+\n"))) << version.out;
}

TEST(Usage, NothingUnknownOrExtraIsAccepted) {
  EXPECT_TRUE(refused(pellucid({}), 2, {"subcommand"}));
  EXPECT_TRUE(refused(pellucid({"rendr"}), 2, {"'rendr'", "'render'"}));
  EXPECT_TRUE(refused(pellucid({"sweep", "rn"}), 2, {"'rn'", "'run'"}));
  EXPECT_TRUE(refused(pellucid({"qqqqqqqq"}), 2, {"qqqqqqqq", "render", "compare"}));
  EXPECT_TRUE(refused(pellucid({"list", "nonsense"}), 2, {"nonsense"}));
  EXPECT_TRUE(refused(pellucid({"list", "--jsn"}), 2, {"--jsn"}));
  EXPECT_TRUE(refused(pellucid({"list", "scenes", "more"}), 2, {"more"}));
  EXPECT_TRUE(refused(pellucid({"describe"}), 2, {"name"}));
  EXPECT_TRUE(refused(pellucid({"sweep"}), 2, {"subcommand"}));
}

TEST(List, GivesTechniquesScenesAndPapers) {
  const Outcome listed = pellucid({"list", "--json"});
  ASSERT_TRUE(succeeded(listed));
  EXPECT_EQ(listed.err, "");
  const json all = json::parse(listed.out);
  EXPECT_TRUE(names(all.at("techniques")).contains("sampling_hulls"));
  EXPECT_TRUE(names(all.at("techniques")).contains("volume_slices"));
  EXPECT_TRUE(names(all.at("scenes")).contains("fog_forest"));
  EXPECT_TRUE(names(all.at("papers")).contains("sampling_hulls"));
  for (const char* part : {"techniques", "scenes", "papers"}) {
    const Outcome one = pellucid({"list", part, "--json"});
    ASSERT_TRUE(succeeded(one));
    EXPECT_EQ(json::parse(one.out), all.at(part)) << part;
  }
}

TEST(List, PlainTextNamesTheSame) {
  const json all = json::parse(pellucid({"list", "--json"}).out);
  const Outcome plain = pellucid({"list"});
  ASSERT_TRUE(succeeded(plain));
  for (const char* part : {"techniques", "scenes", "papers"}) {
    for (const std::string& name : names(all.at(part)))
      EXPECT_NE(plain.out.find("\n  " + name + " "), std::string::npos) << name;
  }
}

TEST(List, EveryTechniqueCitesTheBibliography) {
  const std::string bibliography = read_file(PELLUCID_SOURCE_DIR "/references.bib");
  for (const json& technique : json::parse(pellucid({"list", "techniques", "--json"}).out)) {
    const std::string key = technique.at("reference").get<std::string>();
    EXPECT_NE(bibliography.find("{" + key + ",\n"), std::string::npos) << key;
  }
}

TEST(List, TellsWhenNobodyCanReadIt) {
  const Outcome full = run({"sh", "-c", "'" PELLUCID_PROGRAM "' list --json >/dev/full"});
  EXPECT_TRUE(refused(full, 1, {"standard output"}));
}

TEST(Describe, EveryTechniqueDocumentsItsParameters) {
  for (const std::string& name : names(json::parse(pellucid({"list", "techniques", "--json"}).out))) {
    const Outcome described = pellucid({"describe", name, "--json"});
    ASSERT_TRUE(succeeded(described));
    const json technique = json::parse(described.out);
    EXPECT_EQ(technique.at("name"), name);
    ASSERT_FALSE(technique.at("parameters").empty()) << name;
    const std::string text = pellucid({"describe", name}).out;
    for (const json& parameter : technique.at("parameters")) {
      EXPECT_FALSE(parameter.at("doc").get<std::string>().empty());
      EXPECT_FALSE(parameter.at("cite").get<std::string>().empty());
      EXPECT_NE(text.find("\n  " + parameter.at("name").get<std::string>() + " "), std::string::npos) << text;
      if (parameter.contains("min")) {
        EXPECT_GE(parameter.at("default"), parameter.at("min"));
        EXPECT_LE(parameter.at("default"), parameter.at("max"));
      }
    }
  }
}

TEST(Describe, EverySceneLoadsAndNamesItsViews) {
  for (const std::string& name : names(json::parse(pellucid({"list", "scenes", "--json"}).out))) {
    const Outcome described = pellucid({"describe", name, "--json"});
    ASSERT_TRUE(succeeded(described)) << name;
    const json scene = json::parse(described.out);
    EXPECT_FALSE(scene.at("views").empty()) << name;
    EXPECT_FALSE(scene.at("description").get<std::string>().empty()) << name;
  }
}

TEST(Describe, SuggestsTheNearestName) {
  EXPECT_TRUE(refused(pellucid({"describe", "sampling_hull"}), 2, {"sampling_hull", "'sampling_hulls'"}));
  EXPECT_TRUE(refused(pellucid({"describe", "nothing_like_it.toml"}), 2, {"nothing_like_it.toml"}));
}

// It is moved, packed and given away: where it was built is nobody's concern.
TEST(Program, HoldsNoPathOfItsSourceTree) {
#ifdef PELLUCID_SANITIZE
  GTEST_SKIP() << "the sanitizers' reports name each file where it lies";
#endif
  const std::string program = read_file(PELLUCID_PROGRAM);
  ASSERT_GT(program.size(), 1'000'000U);
  EXPECT_NE(program.find("sweeps/workers/process.cpp"), std::string::npos) << "asserts name their files from the root";
  const std::size_t at = program.find(std::string(PELLUCID_SOURCE_DIR) + "/");
  EXPECT_EQ(at, std::string::npos) << program.substr(at == std::string::npos ? 0 : at, 200);
}

TEST(Devices, ListsOneThatRenders) {
  const Outcome listed = pellucid({"devices", "--json"}, {.environment = {{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}}});
  ASSERT_TRUE(succeeded(listed));
  const json devices = json::parse(listed.out);
  ASSERT_FALSE(devices.empty());
  for (const json& device : devices) {
    for (const char* field : {"vendor", "renderer", "version"})
      EXPECT_FALSE(device.at(field).get<std::string>().empty());
  }
  const Outcome plain = pellucid({"devices"});
  ASSERT_TRUE(succeeded(plain));
  EXPECT_NE(plain.out.find(devices.front().at("renderer").get<std::string>()), std::string::npos);
}

}  // namespace
}  // namespace pellucid::test
