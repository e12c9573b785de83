// The tables of geocube and distance impostors: published numbers, and ours from the rows of their blocks.
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sweeps/tables/tables.hpp"
#include "tests/sweeps/table_texts.hpp"

namespace pellucid::sweeps::test {
namespace {

using nlohmann::json;

json row(const char* sweep, const char* block, const char* technique, const char* scene, json values) {
  json out{{"point", std::string(block) + scene + values.dump()},
           {"sweep", sweep},
           {"block", block},
           {"technique", technique},
           {"scene", scene},
           {"view", "front"},
           {"width", 512},
           {"height", 512},
           {"status", "ok"},
           {"frame_ms_median", 50.0},
           {"frame_ms_ci95_low", 49.0},
           {"frame_ms_ci95_high", 51.0},
           {"fps", 20.0},
           {"frames", 30},
           {"timing", "converged"},
           {"clock", "finish"},
           {"device", "renderer A"},
           {"driver", "driver 1"},
           {"commit", "0"},
           {"dirty", false}};
  out.update(values);
  return out;
}

TEST(GeocubeTables, Table2PutsOursBesideThePapers) {
  const Table table = make_table("geocube.table2", {row("geocube_table2", "bunny", "geocube", "glass_bunny",
                                                        {{"precomputation_s", 0.65}, {"object_triangles", 75408}})});
  EXPECT_EQ(row_of(table, "precomputation [s] (paper)").cells.at(1).value, 1085.0);
  EXPECT_EQ(row_of(table, "precomputation [s] (ours)").cells.at(1).value, 0.65);
  EXPECT_EQ(row_of(table, "triangles (ours)").cells.at(1).text, "75408");
  EXPECT_EQ(row_of(table, "fps (paper)").cells.at(1).value, 14.0);
  EXPECT_EQ(row_of(table, "fps (ours)").cells.at(1).value, 20.0);
  for (const std::size_t missing : {0U, 2U})
    EXPECT_FALSE(row_of(table, "fps (ours)").cells.at(missing).value) << missing;
  EXPECT_EQ(table.records.size(), 6U) << "frame rate and precomputation of three models";
}

TEST(GeocubeTables, Fig16TellsMethodsAndScenesApart) {
  const Table table = make_table(
      "geocube.fig16",
      {row("geocube_figures", "automatic", "geocube", "glass_bunny", {{"cubes", 2}, {"flip_mean_mask", 0.2}}),
       row("geocube_figures", "automatic", "geocube", "glass_bunny", {{"cubes", 5}, {"flip_mean_mask", 0.1}}),
       row("geocube_figures", "hand", "geocube", "glass_bunny", {{"cubes", 2}, {"flip_mean_mask", 0.25}}),
       row("geocube_figures", "automatic", "geocube", "glass_torus", {{"cubes", 2}, {"flip_mean_mask", 0.3}})});
  EXPECT_EQ(row_of(table, "FLIP on the object, glass_bunny").cells.at(7).value, 0.2);
  EXPECT_EQ(row_of(table, "FLIP on the object, glass_bunny").cells.at(8).value, 0.1);
  EXPECT_EQ(row_of(table, "FLIP on the object, glass_bunny").cells.at(5).value, 0.25);
  EXPECT_EQ(row_of(table, "FLIP on the object, glass_torus").cells.at(7).value, 0.3);
}

TEST(GeocubeTables, BoundsTellsSetsAndScenesApart) {
  std::vector<json> rows;
  int n = 0;
  for (const char* scene : {"glass_bunny", "glass_torus"}) {
    for (const char* cones : {"none", "a", "abc"}) {
      for (const bool sphere : {false, true}) {
        ++n;
        rows.push_back(row("geocube_curves", "bounds", "geocube", scene,
                           {{"cones", cones},
                            {"sphere", sphere},
                            {"exit_error_mean", 0.01 * n},
                            {"early_share", 0.02 * n},
                            {"bounded_share", 0.03 * n},
                            {"steps_mean", 2.0 * n},
                            {"flip_mean_mask", 0.04 * n}}));
      }
    }
  }
  // Another block of the sweep has the same parameters.
  rows.push_back(row("geocube_curves", "resolution", "geocube", "glass_bunny",
                     {{"cones", "abc"}, {"sphere", true}, {"resolution", 8}, {"exit_error_mean", 5.0}}));
  rows.push_back(row("geocube_curves", "bounds", "geocube", "glass_torus",
                     {{"cones", "bc"}, {"sphere", true}, {"status", "failed"}, {"failure", "lost"}}));
  const Table table = make_table("geocube.bounds", rows);
  EXPECT_EQ(table.rows.size(), 1U + 2 * 16);
  EXPECT_EQ(table.rows.front().cells.size(), 6U);
  const auto values = [&](const char* label) {
    std::vector<double> out;
    for (const TableCell& cell : row_of(table, label).cells)
      out.push_back(cell.value.value_or(-1));
    return out;
  };
  EXPECT_EQ(values("glass_bunny: none, δ alone"), (std::vector<double>{0.01, 0.02, 0.03, 2, 0.04, 20}));
  EXPECT_EQ(values("glass_bunny: D").at(3), 4);
  EXPECT_EQ(values("glass_bunny: A").at(3), 6);
  EXPECT_EQ(values("glass_bunny: A, B, C, D").at(3), 12);
  EXPECT_EQ(values("glass_torus: A, B, C").at(3), 22);
  EXPECT_EQ(values("glass_torus: B, C").at(3), -1) << "not measured";
  EXPECT_EQ(row_of(table, "glass_torus: B, C, D").cells.at(0).text, "failed");
  EXPECT_EQ(table.records.size(), 32U);
  EXPECT_EQ(make_table("geocube.bounds", {rows.back()}).rows.size(), 1U + 16) << "one scene alone";
}

TEST(ImpostorTables, Fig5TellsPlacesOfTheBallApart) {
  std::vector<json> rows;
  for (const double x : {0.0, 1.6, 2.7}) {
    rows.push_back(row("distance_impostors_figures", "fig5", "distance_impostors", "mirror_room",
                       {{"iterations", 2}, {"scene.ball_x", x}, {"flip_mean_mask", 0.01 + x / 100}}));
  }
  const Table table = make_table("distance_impostors.fig5", rows);
  EXPECT_EQ(row_of(table, "FLIP on the object, in the middle").cells.at(5).value, 0.01);
  EXPECT_EQ(row_of(table, "FLIP on the object, in a corner").cells.at(5).value, 0.01 + 2.7 / 100);
  EXPECT_FALSE(row_of(table, "FLIP on the object, in a corner").cells.at(4).value);
}

TEST(ImpostorTables, Fig6SaysWhereItsResidualLies) {
  const std::vector<json> rows{
      row("distance_impostors_figures", "fig6", "distance_impostors", "mirror_room_box",
          {{"iterations", 2}, {"flip_mean_mask", 0.08}, {"hits_hidden_share", 0.015}, {"flip_share_hidden", 0.1}}),
      row("distance_impostors_figures", "fig6_steps", "distance_impostors", "mirror_room_box",
          {{"iterations", 2}, {"linear_steps", 8}, {"flip_mean_mask", 0.06}, {"flip_share_other_surface", 0.02}})};
  const Table table = make_table("distance_impostors.fig6", rows);
  EXPECT_EQ(table.rows.front().cells.size(), 9U);
  EXPECT_EQ(row_of(table, "part of FLIP: hidden").cells.at(5).value, 0.1);
  EXPECT_EQ(row_of(table, "share of hits: hidden").cells.at(5).value, 0.015);
  EXPECT_EQ(row_of(table, "FLIP on the object").cells.at(8).value, 0.06);
  EXPECT_EQ(row_of(table, "part of FLIP: on another surface").cells.at(8).value, 0.02);
  EXPECT_FALSE(row_of(table, "FLIP on the object").cells.at(7).value) << "4 steps are not measured";
}

TEST(ImpostorTables, RatesGiveTheRangeThatThePaperNames) {
  const Table table = make_table(
      "distance_impostors.rates",
      {row("distance_impostors_scenes", "fig14", "distance_impostors", "armour_hall", {{"flip_mean", 0.05}})});
  EXPECT_EQ(row_of(table, "fps (paper)").cells.at(5).text, "105 to 130");
  EXPECT_EQ(row_of(table, "fps (paper)").cells.at(0).value, 182.0);
  EXPECT_EQ(row_of(table, "fps (ours)").cells.at(5).value, 20.0);
}

}  // namespace
}  // namespace pellucid::sweeps::test
