// Every table of the papers against what the program gave when each table was a piece of C++ of its own: from the same
// rows the same values, in JSON, CSV and LaTeX. data/tables/rows.jsonl has rows for the papers' points with made-up
// values, some failed, unconverged, untimed or missing; the files beside it were written by that program.
#include <cstddef>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "gl/resources/resources.hpp"
#include "sweeps/tables/tables.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;

const std::string kFolder = PELLUCID_SOURCE_DIR "/tests/sweeps/data/tables/";

std::string read_file(const std::string& name) {
  std::ifstream file(kFolder + name, std::ios::binary);
  EXPECT_TRUE(file.is_open()) << name;
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

const std::vector<json>& rows() {
  static const std::vector<json> all = [] {
    std::vector<json> read;
    std::ifstream file(kFolder + "rows.jsonl");
    for (std::string line; std::getline(file, line);)
      read.push_back(json::parse(line));
    return read;
  }();
  return all;
}

class KeptTables : public testing::TestWithParam<const char*> {};

TEST_P(KeptTables, GiveTheSameValues) {
  ASSERT_GT(rows().size(), 200U);
  const std::string name = GetParam();
  const Table table = make_table(name, rows());
  EXPECT_EQ(format_table(table, TableFormat::csv), read_file(name + ".csv"));

  const json now = json::parse(format_table(table, TableFormat::json)), then = json::parse(read_file(name + ".json"));
  ASSERT_EQ(now.size(), then.size());
  ASSERT_GT(then.size(), 0U);
  for (std::size_t i = 0; i < then.size(); ++i) {
    for (const auto& [field, value] : then[i].items()) {
      ASSERT_TRUE(now[i].contains(field)) << "record " << i << " lacks " << field;
      EXPECT_EQ(now[i].at(field), value) << "record " << i << ", " << field;
    }
  }
  // The notes below it have other words by now.
  const auto tabular = [](const std::string& text) { return text.substr(0, text.find("\\bottomrule")); };
  EXPECT_EQ(tabular(format_table(table, TableFormat::latex)), tabular(read_file(name + ".tex")));
}

INSTANTIATE_TEST_SUITE_P(All, KeptTables,
                         testing::Values("sampling_hulls.table1", "sampling_hulls.fig8", "sampling_hulls.fig9",
                                         "sampling_hulls.fig10", "sampling_hulls.fig11", "sampling_hulls.equal",
                                         "sampling_hulls.shadows", "sampling_hulls.references",
                                         "distance_impostors.fig5", "distance_impostors.fig6",
                                         "distance_impostors.fig7", "distance_impostors.rates", "geocube.table2",
                                         "geocube.fig16", "geocube.bounds"));

TEST(KeptTables, NotesSayWhereTheRowsComeFrom) {
  std::string notes;
  for (const std::string& note : make_table("geocube.table2", rows()).notes)
    notes += note + "\n";
  for (const char* part :
       {"Paper: Chan and Wang 2005, Table 2: Pentium 4 3 GHz, GeForce 6800",
        "Ours: Synthetic GPU, 1.0; 512 × 512; timed", "Scene glass_bunny, view ", "Commit 0123456789ab."})
    EXPECT_NE(notes.find(part), std::string::npos) << part << " in\n" << notes;
}

// A paper that repeats the tables of another under its own name is a file and no more.
TEST(KeptTables, APaperUnderAnotherNameIsAFileAlone) {
  std::size_t filled = 0;
  for (const PaperPointer& paper : papers()) {
    const std::string text = "name = \"another\"\n" + find_resource(paper->file.shown).value_or("");
    const PaperPointer another = parse_paper(text, "another.toml");
    const std::vector<std::string> names = entry_names(*another, "tables");
    ASSERT_EQ(names, entry_names(*paper, "tables"));
    for (const std::string& name : names) {
      const Table copy = make_table(PaperEntry{another, name}, rows());
      EXPECT_EQ(copy.info.name, "another." + name);
      EXPECT_EQ(copy.info.address, "another.toml:" + name);
      const Table first = make_table(PaperEntry{paper, name}, rows());
      EXPECT_EQ(copy.sweep, first.sweep);
      EXPECT_EQ(format_table(copy, TableFormat::csv), format_table(first, TableFormat::csv));
      filled += copy.sweep.empty() ? 0 : 1;
    }
  }
  EXPECT_EQ(filled, 15U) << "those that have rows here";
}

}  // namespace
}  // namespace pellucid::sweeps
