// pellucid reproduce FILE.toml: a user's own file, from its sweep to its page.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/sandbox/program.hpp"

namespace pellucid::test {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

const std::string kSpec = R"(name = "mine"
metrics = ["rmse", "flip"]
timeout_s = 60
[timing]
min_samples = 3
max_samples = 3
max_seconds = 1
[reference]
tolerance = 1e-3
[[run]]
name = "hulls"
techniques = ["sampling_hulls"]
scenes = ["SCENE"]
sizes = ["64x48"]
keep = "exr"
[run.axes]
hulls = [1, 2, 4, 8]
[run.fixed]
samples = 2
[preview]
sizes = ["48x36"]
[preview.axes]
hulls = [1, 4]
)";

const std::string kPaper = R"toml(title = "Hulls of mine"
sweeps = ["spec.toml"]

[quantities.points_along_ray]
label = "points along a ray"
doc = "M·N"
expression = "hulls * samples"

[[figures]]
name = "error"
title = "Error over points"
doc = "mean FLIP over the points along a ray"
sweep = "mine"
x = "points_along_ray"
y = "flip_mean"

[[pictures]]
name = "fog"
title = "A box of fog"
scene = "SCENE"
size = "64x48"
settings = { scene.density = 2.0 }
reference = { surfaces = "forward" }
close_up = { of = "one", size = "16x12" }

[[pictures.shown]]
name = "one"
label = "(a)"
technique = "sampling_hulls"
settings = { hulls = 1, samples = 1, frame.format = "single" }
role = "As few points as there can be."

[[pictures]]
name = "traced"
title = "The same, traced"
same_as = "fog"
reference = { surfaces = "rays" }
close_up = { x = 4, y = 2, size = "16x12", why = "a corner" }

[tables.hulls]
title = "Error of so many hulls"
columns = { hulls = [1, 2, 4] }
rows = [{ show = "name", label = "hulls" }, { quantity = "points_along_ray", paper = [2, "none", "7..9"] }, { quantity = "rmse" }]
)toml";

class ReproducePaper : public testing::Test {
 protected:
  TemporaryFolder folder;
  std::filesystem::path paper = folder / "mine.toml", out = folder / "out";

  void SetUp() override {
    const std::string scene = write_small_scene(folder).filename().string();
    write_file(folder / "spec.toml", with(kSpec, "SCENE", scene));
    write_file(paper, with(kPaper, "SCENE", scene));
  }
  static std::string with(std::string text, const std::string& word, const std::string& other) {
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + other.size()))
      text.replace(at, word.size(), other);
    return text;
  }
  void change(const std::string& word, const std::string& other) {
    write_file(paper, with(read_file(paper), word, other));
  }
  json reproduce() {
    const Outcome outcome = pellucid({"reproduce", paper.string(), "--preview", "-o", out.string(), "--json"});
    EXPECT_TRUE(succeeded(outcome));
    return json::parse(outcome.out).at("papers").at(0);
  }
};

TEST_F(ReproducePaper, AFileOfOnesOwnFromItsSweepToItsPage) {
  const json done = reproduce();
  EXPECT_EQ(done.at("paper"), "mine");
  EXPECT_EQ(done.at("sweeps").at(0).at("sweep"), "mine_preview");
  EXPECT_EQ(done.at("sweeps").at(0).at("measured"), 2);

  // The chart's data are those of the store.
  ASSERT_EQ(done.at("figures").size(), 1U);
  EXPECT_EQ(done.at("figures").at(0).at("figure"), "mine.error");
  const std::string store = done.at("sweeps").at(0).at("store");
  const Outcome printed = pellucid({"results", store, "--format", "json"});
  std::istringstream csv(read_file(out / "mine" / "figures" / "error.csv"));
  std::string line;
  ASSERT_TRUE(std::getline(csv, line));
  EXPECT_EQ(line, "line,points_along_ray,flip_mean,flip_mean_low,flip_mean_high,joined\r");
  for (const json& row : json::parse(printed.out)) {
    ASSERT_TRUE(std::getline(csv, line));
    std::istringstream fields(line);
    std::string name, x, y;
    std::getline(std::getline(std::getline(fields, name, ','), x, ','), y, ',');
    EXPECT_EQ(std::stod(x), 2 * row.at("hulls").get<double>());
    EXPECT_EQ(std::stod(y), row.at("flip_mean").get<double>());
  }

  // So are the table's; the preview has no row of two hulls.
  ASSERT_EQ(done.at("tables").size(), 1U);
  const json table = json::parse(read_file(out / "mine" / "tables" / "hulls.json"));
  ASSERT_EQ(table.size(), 3U);
  EXPECT_EQ(table[0].at("paper"), 2.0);
  EXPECT_EQ(table[0].at("ours"), 2.0);
  EXPECT_EQ(table[1].at("outcome"), "missing");
  EXPECT_EQ(table[2].at("paper_high"), 9.0);
  EXPECT_EQ(table[2].at("ours"), 8.0);
  for (const json& row : json::parse(printed.out)) {
    const json& record = table[row.at("hulls") == 1 ? 0 : 2];
    EXPECT_EQ(record.at("rmse"), row.at("rmse"));
  }

  ASSERT_EQ(done.at("pictures").size(), 2U);
  for (const json& picture : done.at("pictures")) {
    EXPECT_FALSE(picture.at("kept").get<bool>());
    EXPECT_GT(picture.at("flip_mean").get<double>(), 0);
    EXPECT_TRUE(std::filesystem::exists(out / picture.at("exr").get<std::string>()));
  }
  const std::string page = read_file(out / "index.html");
  for (const char* words :
       {"Hulls of mine", "Error of so many hulls", "7 to 9", "Error over points", "figures/error.csv", "A box of fog",
        "Pictures that the sweeps kept", "(a)", "As few points as there can be.", "hulls 1, samples 1", "32×24 pixels",
        "a corner", "the same forward pass, shadow maps included", "The reference is traced"})
    EXPECT_NE(page.find(words), std::string::npos) << words;

  // The sweep keeps its pictures.
  std::size_t thumbnails = 0;
  for (const auto& file : std::filesystem::directory_iterator(out / "mine" / "thumbnails" / "mine_preview")) {
    const std::string name = file.path().filename().string();
    EXPECT_NE(page.find("mine/thumbnails/mine_preview/" + name), std::string::npos);
    EXPECT_NE(page.find("mine/mine_preview.db.pictures/" + file.path().stem().string() + ".exr"), std::string::npos);
    ++thumbnails;
  }
  EXPECT_EQ(thumbnails, 2U);

  const json again = reproduce();
  for (const json& picture : again.at("pictures"))
    EXPECT_TRUE(picture.at("kept").get<bool>());
}

TEST_F(ReproducePaper, MistakesAreToldBeforeAnythingIsMeasured) {
  const auto refused_at = [&](const std::string& place, const Words& parts) {
    Words all{"mine.toml:" + place};
    all.insert(all.end(), parts.begin(), parts.end());
    const auto result = refused(pellucid({"reproduce", paper.string(), "--preview", "-o", out.string()}), 2, all);
    SetUp();
    return result;
  };
  change("technique = \"sampling_hulls\"", "technique = \"sampling_hull\"");
  EXPECT_TRUE(refused_at("29:13", {"'sampling_hulls'"}));
  change("hulls = 1, samples = 1", "hulls = 99, samples = 1");
  EXPECT_TRUE(refused_at("30:22", {"[1, 64]"}));
  change("hulls = 1, samples = 1", "hull = 1, samples = 1");
  EXPECT_TRUE(refused_at("30:21", {"'hulls'"}));
  change("of = \"one\"", "of = \"two\"");
  EXPECT_TRUE(refused_at("24:12", {"'two'"}));
  change("size = \"16x12\" }\n\n[[pictures.shown]]", "size = \"16x99\" }\n\n[[pictures.shown]]");
  EXPECT_TRUE(refused_at("24:33", {"beyond"}));
  change("y = \"flip_mean\"", "y = \"flip_maen\"");
  EXPECT_TRUE(refused_at("15:5", {"'flip_mean'"}));
  EXPECT_FALSE(std::filesystem::exists(out / "mine" / "mine_preview.db"));
}

TEST_F(ReproducePaper, AFigureIsPlottedByFileAndName) {
  const std::string store = reproduce().at("sweeps").at(0).at("store");
  const std::filesystem::path svg = folder / "e.svg", csv = folder / "e.csv";
  ASSERT_TRUE(succeeded(
      pellucid({"plot", paper.string() + ":error", "--store", store, "-o", svg.string(), "--data", csv.string()})));
  EXPECT_EQ(read_file(csv), read_file(out / "mine" / "figures" / "error.csv"));
  EXPECT_EQ(read_file(svg), read_file(out / "mine" / "figures" / "error.svg"));
  EXPECT_TRUE(refused(pellucid({"plot", paper.string() + ":eror", "--store", store, "-o", svg.string()}), 2,
                      {"mine.toml", "'error'"}));
}

}  // namespace
}  // namespace pellucid::test
