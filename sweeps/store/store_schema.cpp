#include "sweeps/store/store_schema.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "sweeps/store/store.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;

constexpr const char* kDriftName = "baseline_drift";  // no field of a row: it changes with what is measured afterwards
constexpr int kApplicationId = 0x50454c43;            // "PELC"

// Rows are flat JSON objects: their columns are the parameters of whatever techniques there are. Fields that queries
// need stand beside them. A point has a row for each device and driver that it was measured on; one that failed before
// its worker said hello has neither.
constexpr const char* kPoints = R"(
CREATE TABLE points(id TEXT NOT NULL, device TEXT NOT NULL, driver TEXT NOT NULL, failed INTEGER NOT NULL,
                    done_unix_s REAL NOT NULL, row TEXT NOT NULL, frame_ms BLOB NOT NULL,
                    PRIMARY KEY(id, device, driver));
)";
// Since version 2. A run is one call of `sweep run`; its times say where its wall time went.
constexpr const char* kSince2 = R"(
CREATE TABLE columns(name TEXT PRIMARY KEY, type TEXT NOT NULL, kind TEXT NOT NULL, unit TEXT NOT NULL, description TEXT NOT NULL);
CREATE TABLE runs(id INTEGER PRIMARY KEY, sweep TEXT NOT NULL, host TEXT NOT NULL, device TEXT NOT NULL, driver TEXT NOT NULL,
                  shard TEXT NOT NULL, started_unix_s REAL NOT NULL, wall_s REAL NOT NULL, measuring_s REAL NOT NULL,
                  starting_s REAL NOT NULL, storing_s REAL NOT NULL, points INTEGER NOT NULL);
)";
constexpr const char* kSchema = R"(
CREATE TABLE sweeps(name TEXT PRIMARY KEY, title TEXT NOT NULL, source TEXT NOT NULL, spec TEXT NOT NULL, rank INTEGER NOT NULL);
CREATE TABLE members(sweep TEXT NOT NULL, rank INTEGER NOT NULL, block TEXT NOT NULL, point TEXT NOT NULL,
                     PRIMARY KEY(sweep, rank)) WITHOUT ROWID;
CREATE TABLE baselines(rank INTEGER PRIMARY KEY, sweep TEXT NOT NULL, point TEXT NOT NULL, unix_s REAL NOT NULL,
                       frame_ms_median REAL NOT NULL, frame_ms BLOB NOT NULL, device TEXT NOT NULL DEFAULT '',
                       driver TEXT NOT NULL DEFAULT '', host TEXT NOT NULL DEFAULT '');
)";

// The baseline's measurements around a row's time, and the first, of its device, driver and host: with them the view
// works out what drift_at() in store.cpp does. A spec whose baseline has changed starts a new series.
constexpr const char* kBaselineOfRow = R"((SELECT rank FROM baselines WHERE sweep = m.sweep
  AND point = (SELECT point FROM baselines WHERE sweep = m.sweep ORDER BY unix_s DESC, device DESC, driver DESC, host DESC LIMIT 1)
  AND device IN ('', p.device) AND driver IN ('', p.driver)
  AND (host = '' OR host = coalesce(json_extract(p.row, '$.host'), host))
  {} LIMIT 1))";
constexpr const char* kRowTime = "coalesce(json_extract(p.row, '$.timed_unix_s'), 0)";
constexpr const char* kDrift = R"(
  CASE WHEN coalesce(json_extract(p.row, '$.timing'), 'off') = 'off' THEN NULL
  WHEN after.rank IS NULL THEN before.frame_ms_median / first.frame_ms_median - 1
  WHEN before.rank IS NULL THEN after.frame_ms_median / first.frame_ms_median - 1
  ELSE (before.frame_ms_median + ({0} - before.unix_s) / (after.unix_s - before.unix_s) *
        (after.frame_ms_median - before.frame_ms_median)) / first.frame_ms_median - 1 END)";

std::string set_version(int version) {
  return fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {};", kApplicationId, version);
}

/// A name as SQL quotes it.
std::string sql_quoted(std::string_view name, char quote = '"') {
  std::string out(1, quote);
  for (const char c : name) {
    if (c == quote) out += c;
    out += c;
  }
  return out + quote;
}

/// Where a column's value stands in the row: an object's members are opened, `pass_ms.fog`.
std::string json_path(const std::string& name) {
  constexpr std::string_view kPasses = "pass_ms.";
  if (name.starts_with(kPasses)) return fmt::format("$.\"pass_ms\".\"{}\"", name.substr(kPasses.size()));
  return fmt::format("$.\"{}\"", name);
}

const char* sql_type(const json& value) {
  if (value.is_boolean() || value.is_number_integer()) return "INTEGER";
  if (value.is_number()) return "REAL";
  return "TEXT";
}

}  // namespace

void create_schema(Database& database) {
  Transaction transaction(database);
  database.run(set_version(kSchemaVersion));
  database.run(kSchema);
  database.run(kPoints);
  database.run(kSince2);
  transaction.commit();
}

void check_schema(const Database& database, const std::filesystem::path& path) {
  if (database.integer("PRAGMA application_id") != kApplicationId)
    throw InputError(fmt::format("store '{}' is not a Pellucid store", path.string()));
  const std::int64_t version = database.integer("PRAGMA user_version");
  if (version < 1 || version > kSchemaVersion) {
    throw InputError(
        fmt::format("store '{}' has schema version {}, and this program reads versions 1 to {}; use the program that "
                    "made it, or another store",
                    path.string(), version, kSchemaVersion));
  }
}

void migrate_schema(Database& database) {
  if (database.integer("PRAGMA user_version") != 1) return;
  Transaction transaction(database);
  database.run("ALTER TABLE points RENAME TO points_1");
  database.run(kPoints);
  database.run(kSince2);
  database.run(
      "INSERT INTO points SELECT id, coalesce(json_extract(row, '$.device'), ''), coalesce(json_extract(row, "
      "'$.driver'), ''), failed, done_unix_s, row, frame_ms FROM points_1; DROP TABLE points_1;");
  for (const char* column : {"device", "driver", "host"})
    database.run(fmt::format("ALTER TABLE baselines ADD COLUMN {} TEXT NOT NULL DEFAULT ''", column));
  database.run(set_version(2));
  std::vector<std::string> rows;  // first, since the view changes with them
  {
    Statement statement(database, "SELECT row FROM points");
    while (statement.step())
      rows.push_back(statement.text(0));
  }
  ResultsView view(database);
  for (const std::string& text : rows) {
    const json row = json::parse(text, nullptr, false);
    if (row.is_object()) view.add(row);
  }
  transaction.commit();
}

void present_as_current(Database& database) {
  if (database.integer("PRAGMA user_version") != 1) return;
  // A temporary view hides the table of its name.
  database.run(
      "PRAGMA query_only = 0;"
      "CREATE TEMP VIEW points AS SELECT id, CASE WHEN json_valid(row) THEN coalesce(json_extract(row, '$.device'), "
      "'') "
      "ELSE '' END AS device, CASE WHEN json_valid(row) THEN coalesce(json_extract(row, '$.driver'), '') ELSE '' END "
      "AS "
      "driver, failed, done_unix_s, row, frame_ms FROM main.points;"
      "CREATE TEMP VIEW baselines AS SELECT *, '' AS device, '' AS driver, '' AS host FROM main.baselines;"
      "CREATE TEMP VIEW columns AS SELECT '' AS name, '' AS type, '' AS kind, '' AS unit, '' AS description WHERE 0;"
      "CREATE TEMP VIEW runs AS SELECT 0 AS id, '' AS sweep, '' AS host, '' AS device, '' AS driver, '' AS shard, 0.0 "
      "AS "
      "started_unix_s, 0.0 AS wall_s, 0.0 AS measuring_s, 0.0 AS starting_s, 0.0 AS storing_s, 0 AS points WHERE 0;"
      "PRAGMA query_only = 1;");
}

void ResultsView::load() {
  if (loaded_) return;
  loaded_ = true;
  Statement columns(database_, "SELECT name, type FROM columns");
  while (columns.step())
    known_[columns.text(0)] = columns.text(1);
  // An earlier version of the program may have defined it otherwise.
  Statement view(database_, "SELECT sql FROM sqlite_master WHERE name = 'results'");
  stale_ = !view.step() || view.text(0) != definition();
}

void ResultsView::describe(const std::string& name, const std::string& type, const std::string& kind,
                           const std::string& unit, const std::string& description) {
  load();
  Statement(database_,
            "INSERT INTO columns VALUES(?1, ?2, ?3, ?4, ?5) ON CONFLICT(name) DO UPDATE SET type = ?2, kind = ?3, "
            "unit = ?4, description = ?5")
      .bind(1, name)
      .bind(2, type)
      .bind(3, kind)
      .bind(4, unit)
      .bind(5, description)
      .step();
  const auto [at, is_new] = known_.try_emplace(name);
  if (!is_new && at->second == type) return;
  at->second = type;
  stale_ = true;
}

void ResultsView::describe(const Plan& plan) {
  for (const char* name : {"sweep", "block", "point"})
    describe(name, "TEXT", "result", meaning(name).unit, meaning(name).description);
  describe(kDriftName, "REAL", "result", meaning(kDriftName).unit, meaning(kDriftName).description);
  for (const auto& [name, info] : plan.parameters) {
    const char* type = info.type == ValueType::real ? "REAL" : info.type == ValueType::choice ? "TEXT" : "INTEGER";
    describe(name, type, "parameter", info.unit, info.doc);
  }
  write_view();
}

ColumnMeaning ResultsView::meaning(const std::string& name) const {
  if (const auto known = meanings_.find(name); known != meanings_.end()) return known->second;
  const std::size_t dot = name.find('.');
  const auto object = meanings_.find(name.substr(0, dot));
  if (dot == std::string::npos || object == meanings_.end()) return {};
  return {object->second.unit, fmt::format("{}: {}", object->second.description, name.substr(dot + 1))};
}

void ResultsView::note(const std::string& name, const json& value) {
  if (value.is_null()) return;
  const std::string type = sql_type(value);
  const auto known = known_.find(name);
  if (known == known_.end()) {
    const ColumnMeaning known_as = meaning(name);
    describe(name, type, "result", known_as.unit, known_as.description);
    return;
  }
  if (known->second == type || known->second == "TEXT") return;
  if (known->second == "REAL" && type == "INTEGER") return;
  // A column of integers may hold a real later; anything else that changes is kept as text.
  known->second = type == "TEXT" ? "TEXT" : "REAL";
  Statement(database_, "UPDATE columns SET type = ?2 WHERE name = ?1").bind(1, name).bind(2, known->second).step();
  stale_ = true;
}

void ResultsView::add(const json& row) {
  load();
  for (const auto& [name, value] : row.items()) {
    if (!value.is_object()) {
      note(name, value);
      continue;
    }
    for (const auto& [inner, inner_value] : value.items())
      note(name + "." + inner, inner_value);
  }
  write_view();
}

std::string ResultsView::definition() const {
  std::string sql = "CREATE VIEW results AS SELECT m.sweep, m.block, p.id AS point";
  for (const auto& [name, type] : known_) {
    if (name == "sweep" || name == "block" || name == "point" || name == kDriftName) continue;
    sql += fmt::format(", CAST(json_extract(p.row, {}) AS {}) AS {}", sql_quoted(json_path(name), '\''), type,
                       sql_quoted(name));
  }
  sql += fmt::format(",{} AS {}", fmt::format(kDrift, kRowTime), kDriftName);
  sql += " FROM members m JOIN sweeps s ON s.name = m.sweep JOIN points p ON p.id = m.point";
  const auto join = [&](const char* alias, const std::string& which) {
    sql += fmt::format(" LEFT JOIN baselines {0} ON {0}.rank = {1}", alias, fmt::format(kBaselineOfRow, which));
  };
  join("first", "ORDER BY unix_s");
  join("before", fmt::format("AND unix_s < {} ORDER BY unix_s DESC", kRowTime));
  join("after", fmt::format("AND unix_s >= {} ORDER BY unix_s", kRowTime));
  return sql + " ORDER BY s.rank, m.rank, p.device, p.driver";
}

void ResultsView::write_view() {
  if (!stale_) return;
  stale_ = false;
  database_.run(
      "DROP VIEW IF EXISTS results; CREATE INDEX IF NOT EXISTS baselines_in_time ON baselines(sweep, unix_s); " +
      definition() + ";");
}

}  // namespace pellucid::sweeps
