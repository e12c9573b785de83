// The views that a store offers to programs that speak SQL.
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sweeps/store/sqlite.hpp"
#include "sweeps/store/store.hpp"
#include "tests/sweeps/example_store.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;
using test::Example;
using test::fill;
using test::row_of;
using test::TemporaryFolder;

TEST(Store, OffersItsRowsToSql) {
  const TemporaryFolder folder;
  const Example e;
  fill(folder / "s.db", e);
  const Database db(folder / "s.db", Database::Mode::read);
  EXPECT_EQ(db.integer("SELECT count(*) FROM results"), 2);
  EXPECT_EQ(db.integer("SELECT count(*) FROM results WHERE hulls = 2 AND timing = 'converged'"), 2);
  Statement types(
      db, "SELECT typeof(frame_ms_median), typeof(hulls), typeof(device), typeof(\"pass_ms.back\") FROM results");
  ASSERT_TRUE(types.step());
  EXPECT_EQ(types.text(0) + " " + types.text(1) + " " + types.text(2) + " " + types.text(3), "real integer text real");
  Statement column(db, "SELECT type, kind, description FROM columns WHERE name = 'hulls'");
  ASSERT_TRUE(column.step());
  EXPECT_EQ(column.text(0) + " " + column.text(1) + " " + column.text(2), "INTEGER parameter a uniform");
  // A whole number in the first row may be a real one in the next.
  {
    Store store(folder / "s.db", Access::write);
    json row = row_of("ok", 3);
    row["share"] = 1;
    store.put_row(e.plan.points[0].id, row, {});
    row["share"] = 0.5;
    store.put_row(e.plan.points[2].id, row, {});
  }
  EXPECT_EQ(Database(folder / "s.db", Database::Mode::read)
                .integer("SELECT count(*) FROM results WHERE typeof(share) = 'real'"),
            2);
}

/// Every row by SQL, its drift beside that of Store::rows().
void expect_drift_in_sql(const std::filesystem::path& path) {
  const std::vector<json> rows = read_rows(path);
  const Database db(path, Database::Mode::read);
  for (const json& row : rows) {
    for (const auto& [field, value] : row.items()) {
      if (value.is_object()) continue;
      EXPECT_EQ(db.integer(fmt::format("SELECT count(*) FROM pragma_table_info('results') WHERE name = '{}'", field)),
                1)
          << field;
    }
  }
  Statement statement(db, "SELECT baseline_drift, baseline_drift IS NULL, block, point, device FROM results");
  std::size_t at = 0;
  for (; statement.step(); ++at) {
    ASSERT_LT(at, rows.size());
    const json& expected = rows[at].at("baseline_drift");
    EXPECT_EQ(statement.text(3), rows[at].at("point").get<std::string>());
    EXPECT_EQ(statement.integer(1) != 0, expected.is_null()) << at;
    if (expected.is_null()) continue;
    EXPECT_NEAR(statement.real(0), expected.get<double>(), 1e-12) << at;
  }
  EXPECT_EQ(at, rows.size());
}

TEST(Store, OffersTheDriftToSql) {
  const TemporaryFolder folder;
  const Example e;
  const std::filesystem::path path = folder / "s.db";
  fill(path, e);
  expect_drift_in_sql(path);  // no baseline yet
  Store store(path, Access::write);
  const auto baseline = [&](const std::string& point, double at, double ms, const char* device,
                            const char* host = "h") {
    store.put_baseline("s", {point, at, ms, {ms}, device, "v", host});
  };
  baseline("old", 50, 7, "d");  // of an earlier series
  baseline("x", 100, 10, "d");
  baseline("x", 120, 99, "another");
  baseline("x", 140, 5, "d", "elsewhere");
  baseline("x", 200, 12, "d");
  baseline("x", 300, 9, "d");
  baseline("x", 310, 0.5, "another");
  for (const double at : {10.0, 100.0, 130.0, 200.0, 260.0, 400.0}) {
    for (const char* device : {"d", "another"}) {
      json row = row_of("ok", at);
      row["device"] = device;
      row["host"] = "h";
      store.put_row(e.plan.points[0].id, row, {});
      row.erase("host");  // of a row that does not name it
      store.put_row(e.plan.points[2].id, row, {});
    }
    expect_drift_in_sql(path);
  }
  json untimed = row_of("ok", 150);
  untimed["timing"] = "off";
  store.put_row(e.plan.points[0].id, untimed, {});
  expect_drift_in_sql(path);
}

TEST(Store, AnEarlierDefinitionOfTheViewIsReplaced) {
  const TemporaryFolder folder;
  const Example e;
  fill(folder / "s.db", e);
  Database(folder / "s.db", Database::Mode::create).run("DROP VIEW results; CREATE VIEW results AS SELECT 1 AS one");
  fill(folder / "s.db", e);
  expect_drift_in_sql(folder / "s.db");
}

}  // namespace
}  // namespace pellucid::sweeps
