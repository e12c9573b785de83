// A paper as data: its head, the names of its entries, the quantities, and what mistakes say.
#include "sweeps/papers/paper.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "algorithms/technique.hpp"
#include "gl/error.hpp"
#include "sweeps/metrics/metrics.hpp"
#include "tests/input_error.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;

std::string error_of(std::string_view text) {
  return pellucid::test::input_error([&] { parse_paper(text, "my.toml"); });
}

TEST(Paper, TheBuiltInOnesAreReadFromTheirModules) {
  ASSERT_GE(papers().size(), 3U);
  for (const PaperPointer& paper : papers()) {
    EXPECT_EQ(paper->file.shown, "algorithms/" + paper->name + "/paper.toml");
    EXPECT_FALSE(paper->title.empty());
    EXPECT_FALSE(paper->sweeps.empty());
    EXPECT_EQ(find_technique(paper->name).name, paper->name);
    EXPECT_EQ(load_paper(paper->name).get(), paper.get());
  }
}

TEST(Paper, AnUnknownNameIsAnsweredWithTheNearest) {
  try {
    load_paper("geocubes", {"all"});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "unknown paper 'geocubes'; did you mean 'geocube'?");
  }
}

TEST(Paper, MistakesInTheHeadNameTheirPlace) {
  EXPECT_EQ(error_of("title = \"x\"\ntitel = 3"), "my.toml:2:1: unknown key 'titel'; did you mean 'title'?");
  EXPECT_EQ(error_of("title = 3"), "my.toml:1:9: title must be a string, not an integer");
  EXPECT_EQ(error_of("title = \"x\"\nsweeps = [\"geocube_tabel2\"]"),
            "my.toml:2:11: no sweep named 'geocube_tabel2' is built in; did you mean 'geocube_table2'? (a file's name "
            "ends in .toml)");
  EXPECT_EQ(error_of("title = \"x\"\nname = \"My paper\""),
            "my.toml:2:8: name: 'My paper' is not a name: use lower-case letters, digits and underscores, a letter "
            "first");
  EXPECT_TRUE(error_of("title = ").starts_with("my.toml:1:")) << error_of("title = ");
  EXPECT_EQ(error_of("title = \"x\"\n[quantities.twice]\nlabel = \"t\"\nexpression = \"2 * \"").substr(0, 47),
            "my.toml:4:14: quantities.twice.expression: expr");
  EXPECT_EQ(error_of("title = \"x\"\n[quantities.fps]\nlabel = \"t\"\nexpression = \"2\""),
            "my.toml:2:1: quantities.fps: every row has a quantity of this name already");
  EXPECT_EQ(error_of("title = \"x\"\n[quantities.twice]\nlabel = \"t\""),
            "my.toml:2:1: 'expression' is missing in quantities.twice");
}

TEST(Paper, EntriesAreFoundInBothKindsOfSection) {
  const auto paper = parse_paper(
      "title = \"x\"\n[tables.b]\n[tables.a]\n[[figures]]\nname = \"time\"\n[[figures]]\nname = \"error\"", "my.toml");
  EXPECT_EQ(paper->name, "my");
  EXPECT_EQ(entry_names(*paper, "tables"), (std::vector<std::string>{"b", "a"}));
  EXPECT_EQ(entry_names(*paper, "figures"), (std::vector<std::string>{"time", "error"}));
  EXPECT_TRUE(entry_names(*paper, "pictures").empty());
  EXPECT_EQ(read_entry({paper, "error"}, "figures").place().line, 6);
  const auto twice = parse_paper("title = \"x\"\n[[figures]]\nname = \"a\"\n[[figures]]\nname = \"a\"", "my.toml");
  EXPECT_THROW(entry_names(*twice, "figures"), InputError);
}

TEST(Quantities, EveryMetricAndTheFrameTimeAreDeclared) {
  for (const std::string& name : MetricSet().columns(true)) {
    const Quantity* found = find_quantity(name);
    ASSERT_NE(found, nullptr) << name;
    EXPECT_NE(found->better, Better::neither) << name;
  }
  EXPECT_EQ(find_quantity("flip_mean_mask")->label, "mean FLIP on the object");
  EXPECT_EQ(find_quantity("exit_error_mean")->heading, "mean error of the exit point [diagonals]");
  EXPECT_EQ(find_quantity("exit_error_mean")->module, "geocube");
  EXPECT_EQ(find_quantity("no_such"), nullptr);
}

TEST(Quantities, NameUnitsAndIntervalsThatExist) {
  for (const Quantity& quantity : quantities()) {
    EXPECT_FALSE(quantity.label.empty()) << quantity.name;
    EXPECT_FALSE(quantity.doc.empty() || quantity.doc.ends_with('.')) << quantity.name;
    for (const std::string& bound : {quantity.low, quantity.high})
      EXPECT_TRUE(bound.empty() || find_quantity(bound) != nullptr) << quantity.name << ": " << bound;
  }
}

TEST(Quantities, AreWorkedOutByTechnique) {
  const auto paper = parse_paper(R"(
title = "x"
[quantities.samples_along_ray]
label = "samples along a ray"
expression = { sampling_hulls = "hulls * samples", volume_slices = "slices" }
)",
                                 "my.toml");
  const Quantity& samples = paper->quantity("samples_along_ray");
  EXPECT_EQ(value_of(samples, json{{"technique", "sampling_hulls"}, {"hulls", 4}, {"samples", 8}}), 32.0);
  EXPECT_EQ(value_of(samples, json{{"technique", "volume_slices"}, {"slices", 128}}), 128.0);
  EXPECT_EQ(value_of(samples, json{{"technique", "geocube"}, {"slices", 128}}), std::nullopt);
  EXPECT_EQ(value_of(samples, json{{"technique", "sampling_hulls"}, {"hulls", 4}}), std::nullopt);
  EXPECT_EQ(value_of(paper->quantity("fps_ci95_low"), json{{"frame_ms_ci95_high", 20.0}}), 50.0);
  EXPECT_EQ(value_of(paper->quantity("fps_ci95_low"), json{{"frame_ms_ci95_high", 0.0}}), std::nullopt);
  try {
    paper->quantity("flip_maen");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "unknown quantity 'flip_maen'; did you mean 'flip_mean'?");
  }
}

}  // namespace
}  // namespace pellucid::sweeps
