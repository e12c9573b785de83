// A table of a user's own file, and what its mistakes say.
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "sweeps/tables/tables.hpp"
#include "tests/input_error.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;

constexpr const char* kHead = R"(title = "Mine"
source = "Me 2026"
sweeps = ["sampling_hulls_table1"]
[quantities.samples_along_ray]
label = "samples along a ray"
digits = 2
expression = "hulls * samples"
[tables.t]
title = "A table"
)";

PaperEntry entry(const std::string& table) {
  return {parse_paper(kHead + table, "my.toml"), "t"};
}

std::string error_of(const std::string& table) {
  return pellucid::test::input_error([&] { make_table(entry(table), {}); });
}

json row(int hulls, int samples, double fps, double flip, const char* block = "a") {
  return {{"sweep", "sampling_hulls_table1"},
          {"block", block},
          {"point", std::to_string(hulls) + " " + std::to_string(samples) + block},
          {"technique", "sampling_hulls"},
          {"hulls", hulls},
          {"samples", samples},
          {"status", "ok"},
          {"timing", "converged"},
          {"fps", fps},
          {"flip_mean", flip}};
}

TEST(OwnTables, ColumnsAreAProductAndQuantitiesAreWorkedOut) {
  const Table table = make_table(entry(R"(
columns = { hulls = [1, 2], samples = [4, 8] }
name = "{hulls} by {samples}"
rows = [{ show = "name", label = "M by N" }, { quantity = "samples_along_ray" }, { quantity = "flip_mean" },
        { quantity = "fps", paper = ["none", 10, "20..30", 40] }]
)"),
                                 {row(1, 4, 100, 0.25), row(2, 8, 50, 0.125)});
  EXPECT_EQ(format_table(table, TableFormat::csv),
            "M by N,1 by 4,1 by 8,2 by 4,2 by 8\r\n"
            "samples along a ray,4,,,16\r\n"
            "FLIP,0.25,,,0.125\r\n"
            "fps (paper),,10,20 to 30,40\r\n"
            "fps (ours),100,,,50\r\n");
  EXPECT_EQ(table.info.name, "my.t");
  EXPECT_EQ(table.info.address, "my.toml:t");
  EXPECT_EQ(table.info.source, "Me 2026");
  // Without `json` a record says all that tells the columns apart, the result and every row.
  const json first = json::parse(format_table(table, TableFormat::json)).at(3);
  EXPECT_EQ(first.at("column"), "2 by 8");
  EXPECT_EQ(first.at("hulls"), 2);
  EXPECT_EQ(first.at("quantity"), "samples_along_ray");
  EXPECT_EQ(first.at("ours"), 16.0);
  EXPECT_EQ(first.at("flip_mean"), 0.125);
  EXPECT_EQ(first.at("sweep"), "sampling_hulls_table1");
}

TEST(OwnTables, FamiliesAreDividedAndGroupsStack) {
  const Table table = make_table(entry(R"(
columns = [{ hulls = 1, name = "one" }, { hulls = 2, name = "two" }]
groups = [{ samples = 4, name = "few" }, { samples = { any = [8, 9] }, name = "many" }]
families = { new = { block = "b" }, old = { block = "a" } }
family = "new"
rows = [{ show = "name", label = "M" }, { quantity = "flip_mean" }, { quantity = "flip_mean", over = "old", label = "ratio" }]
)"),
                                 {row(1, 4, 1, 0.5, "a"), row(1, 4, 1, 0.25, "b"), row(2, 9, 1, 0.125, "b")});
  EXPECT_EQ(format_table(table, TableFormat::csv),
            "M,one,two\r\n"
            "\"FLIP, few\",0.25,\r\n"
            "\"ratio, few\",0.5,\r\n"
            "\"FLIP, many\",,0.125\r\n"
            "\"ratio, many\",,\r\n");
}

TEST(OwnTables, TransposedTheColumnsAreRows) {
  const Table table = make_table(entry(R"(
columns = [{ hulls = 1, name = "one" }, { hulls = 2, name = "two" }]
transposed = true
corner = "M"
rows = [{ quantity = "flip_mean" }, { quantity = "fps" }]
)"),
                                 {row(1, 4, 10, 0.5), row(2, 8, 20, 0.25)});
  EXPECT_EQ(format_table(table, TableFormat::csv), "M,FLIP,fps\r\none,0.5,10\r\ntwo,0.25,20\r\n");
}

TEST(OwnTables, MistakesNameTheirPlace) {
  const std::string good = "columns = [{ hulls = 1 }]\n";
  EXPECT_EQ(error_of(good + "rows = [{ show = \"name\" }, { quantity = \"flip_maen\" }]"),
            "my.toml:11:41: tables.t.rows[1].quantity: unknown quantity 'flip_maen'; did you mean 'flip_mean'?");
  EXPECT_EQ(error_of(good + "rows = [{ show = \"{hull}\" }, { quantity = \"fps\" }]"),
            "my.toml:11:9: {hull} is unknown here; did you mean 'hulls'?");
  EXPECT_EQ(error_of(good + "rows = [{ show = \"hull\" }, { quantity = \"fps\" }]"),
            "my.toml:11:18: tables.t.rows[0].show: no column has 'hull'; did you mean 'hulls'?");
  EXPECT_EQ(error_of(good + "rows = [{ show = \"name\" }, { quantity = \"fps\", paper = [1, 2] }]"),
            "my.toml:11:56: tables.t.rows[1].paper: a list of 1 values, one for each column");
  EXPECT_EQ(error_of(good + "rows = [{ show = \"name\" }, { quantity = \"fps\", paper = [\"3..2\"] }]"),
            "my.toml:11:57: tables.t.rows[1].paper: a published value is a number, \"105..130\" or \"none\"");
  EXPECT_EQ(error_of(good + "rows = [{ show = \"name\" }, { quantity = \"fps\", relative_to = 1 }]"),
            "my.toml:11:62: tables.t.rows[1].relative_to: a column is one of '1', or its position from 0 to 0");
  EXPECT_EQ(error_of(good + "rows = [{ show = \"name\" }, { quantity = \"fps\", over = \"old\" }]"),
            "my.toml:11:55: tables.t.rows[1].over: the table has no families");
  EXPECT_EQ(error_of(good + "rows = [{ show = \"name\" }, { quantity = \"device\" }]"),
            "my.toml:11:41: tables.t.rows[1].quantity: 'device' holds words; show it with show");
  EXPECT_EQ(error_of(good + "rows = [{ quantity = \"fps\" }]"),
            "my.toml:11:8: tables.t.rows: the first row names the columns: {show = \"…\"}");
  EXPECT_EQ(error_of(good + "sweep = \"sampling_hulls\"\nrows = [{ show = \"name\" }, { quantity = \"fps\" }]"),
            "my.toml:11:9: tables.t.sweep: 'sampling_hulls' is none of the file's `sweeps`; there are "
            "sampling_hulls_table1");
  EXPECT_EQ(error_of(good + "rows = [{ show = \"name\" }, { set = \"errors\" }]"),
            "my.toml:11:36: tables.t.rows[1].set: [row_sets] has no 'errors'");
  EXPECT_EQ(error_of(good + "rows = [{ show = \"name\" }, { quantity = \"fps\" }]\njson = [\"fsp\", \"result\"]"),
            "my.toml:12:9: tables.t.json: 'fsp' is no variable, no row's id and no quantity");
  EXPECT_EQ(error_of(good + "rows = [{ show = \"name\" }, { quantity = \"fps\" }, { quantity = \"fps\" }]"),
            "my.toml:11:50: tables.t.rows[2].id: 'fps' names an earlier row; give one of them an id of its own");
  EXPECT_EQ(error_of("columns = [{ hulls = 1 }]\nrow = [{ show = \"name\" }]"),
            "my.toml:8:1: 'rows' is missing in tables.t");
  EXPECT_EQ(error_of("columns = [{ hulls = [] }]\nrows = [{ show = \"name\" }, { quantity = \"fps\" }]"),
            "my.toml:10:22: tables.t.columns[0].hulls must be a list of at least one value");
  EXPECT_EQ(error_of(good + "rows = [{ show = \"name\" }, { quantity = \"fps\", digit = 3 }]"),
            "my.toml:11:48: unknown key 'digit' in tables.t.rows[1]; did you mean 'digits'?");
}

}  // namespace
}  // namespace pellucid::sweeps
