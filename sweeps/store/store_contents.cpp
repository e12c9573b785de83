// The contents of a store as they stand in the file: what merging reads and writes, and the records of runs.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sweeps/store/store_state.hpp"

namespace pellucid::sweeps {

void Store::all_or_nothing(const std::function<void()>& f) {
  state_->lock->check();
  Transaction transaction(state_->database);
  state_->inside = true;
  try {
    f();
  } catch (...) {
    state_->inside = false;
    throw;
  }
  state_->inside = false;
  transaction.commit();
}

std::vector<StoredPlan> Store::plans() const {
  std::vector<StoredPlan> plans;
  Statement sweeps(state_->database, "SELECT name, title, source, spec FROM sweeps ORDER BY name");
  Statement members(state_->database, "SELECT block, point FROM members WHERE sweep = ?1 ORDER BY rank");
  while (sweeps.step()) {
    StoredPlan plan{sweeps.text(0), sweeps.text(1), sweeps.text(2), sweeps.text(3), {}};
    members.bind(1, plan.name);
    while (members.step())
      plan.members.emplace_back(members.text(0), members.text(1));
    members.reset();
    plans.push_back(std::move(plan));
  }
  return plans;
}

void Store::put(const StoredPlan& plan, int rank) {
  const Database& db = state_->database;
  Statement(db,
            "INSERT INTO sweeps VALUES(?1, ?2, ?3, ?4, ?5) ON CONFLICT(name) DO UPDATE SET "
            "title = ?2, source = ?3, spec = ?4, rank = ?5")
      .bind(1, plan.name)
      .bind(2, plan.title)
      .bind(3, plan.source)
      .bind(4, plan.spec)
      .bind(5, std::int64_t{rank})
      .step();
  Statement(db, "DELETE FROM members WHERE sweep = ?1").bind(1, plan.name).step();
  Statement insert(db, "INSERT INTO members VALUES(?1, ?2, ?3, ?4)");
  for (std::size_t i = 0; i < plan.members.size(); ++i) {
    insert.bind(1, plan.name)
        .bind(2, static_cast<std::int64_t>(i))
        .bind(3, plan.members[i].first)
        .bind(4, plan.members[i].second)
        .step();
    insert.reset();
  }
}

namespace {

constexpr const char* kRow = "SELECT id, device, driver, failed, done_unix_s, row, frame_ms FROM points ";

StoredRow stored_row(const Statement& statement) {
  return {statement.text(0), statement.text(1), statement.text(2),       statement.integer(3) != 0,
          statement.real(4), statement.text(5), read_reals(statement, 6)};
}

}  // namespace

void Store::each_row(const std::function<void(const StoredRow&)>& f) const {
  Statement statement(state_->database, std::string(kRow) + "ORDER BY id, device, driver");
  while (statement.step())
    f(stored_row(statement));
}

std::optional<StoredRow> Store::find(const std::string& id, const std::string& device,
                                     const std::string& driver) const {
  Statement statement(state_->database, std::string(kRow) + "WHERE id = ?1 AND device = ?2 AND driver = ?3");
  statement.bind(1, id).bind(2, device).bind(3, driver);
  if (!statement.step()) return std::nullopt;
  return stored_row(statement);
}

void Store::put(const StoredRow& row) {
  const Database& db = state_->database;
  if (!row.device.empty()) {  // that it failed before it had a device no longer counts
    Statement(db, "DELETE FROM points WHERE id = ?1 AND device = ''").bind(1, row.id).step();
  } else {
    Statement measured(db, "SELECT 1 FROM points WHERE id = ?1 AND device <> ''");
    if (measured.bind(1, row.id).step()) return;
  }
  Statement(db, "INSERT OR REPLACE INTO points VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7)")
      .bind(1, row.id)
      .bind(2, row.device)
      .bind(3, row.driver)
      .bind(4, std::int64_t{row.failed})
      .bind(5, row.done_unix_s)
      .bind(6, row.row)
      .bind(7, std::span<const double>(row.frame_ms_samples))
      .step();
}

std::vector<std::pair<std::string, BaselineSample>> Store::all_baselines() const {
  Statement statement(state_->database,
                      "SELECT sweep, point, unix_s, frame_ms_median, frame_ms, device, driver, host FROM baselines "
                      "ORDER BY unix_s, sweep, device, driver, host");
  std::vector<std::pair<std::string, BaselineSample>> result;
  while (statement.step()) {
    result.emplace_back(statement.text(0), BaselineSample{statement.text(1), statement.real(2), statement.real(3),
                                                          read_reals(statement, 4), statement.text(5),
                                                          statement.text(6), statement.text(7)});
  }
  return result;
}

std::vector<RunRecord> Store::runs() const {
  Statement statement(state_->database,
                      "SELECT sweep, host, device, driver, shard, started_unix_s, wall_s, measuring_s, starting_s, "
                      "storing_s, points FROM runs ORDER BY started_unix_s, host, shard");
  std::vector<RunRecord> result;
  while (statement.step()) {
    result.push_back({statement.text(0), statement.text(1), statement.text(2), statement.text(3), statement.text(4),
                      statement.real(5), statement.real(6), statement.real(7), statement.real(8), statement.real(9),
                      static_cast<std::size_t>(statement.integer(10))});
  }
  return result;
}

void Store::put(const RunRecord& run) {
  Statement(state_->database,
            "INSERT INTO runs(sweep, host, device, driver, shard, started_unix_s, wall_s, measuring_s, starting_s, "
            "storing_s, points) VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11)")
      .bind(1, run.sweep)
      .bind(2, run.host)
      .bind(3, run.device)
      .bind(4, run.driver)
      .bind(5, run.shard)
      .bind(6, run.started_unix_s)
      .bind(7, run.wall_s)
      .bind(8, run.measuring_s)
      .bind(9, run.starting_s)
      .bind(10, run.storing_s)
      .bind(11, static_cast<std::int64_t>(run.points))
      .step();
}

std::int64_t Store::add_run(const RunRecord& run) {
  std::int64_t id = 0;
  state_->commit([&] {
    put(run);
    id = state_->database.integer("SELECT max(id) FROM runs");
  });
  return id;
}

void Store::update_run(std::int64_t id, const RunRecord& run) {
  state_->commit([&] {
    Statement(state_->database,
              "UPDATE runs SET device = ?2, driver = ?3, wall_s = ?4, measuring_s = ?5, starting_s = ?6, storing_s = "
              "?7, points = ?8 WHERE id = ?1")
        .bind(1, id)
        .bind(2, run.device)
        .bind(3, run.driver)
        .bind(4, run.wall_s)
        .bind(5, run.measuring_s)
        .bind(6, run.starting_s)
        .bind(7, run.storing_s)
        .bind(8, static_cast<std::int64_t>(run.points))
        .step();
  });
}

void Store::explain(std::map<std::string, ColumnMeaning> meanings) {
  state_->view.explain(std::move(meanings));
}

void Store::note_columns(const nlohmann::json& row) {
  state_->view.add(row);
}

void Store::copy_columns(const Store& other) {
  Statement statement(other.state_->database, "SELECT name, type, kind, unit, description FROM columns ORDER BY name");
  while (statement.step()) {
    state_->view.describe(statement.text(0), statement.text(1), statement.text(2), statement.text(3),
                          statement.text(4));
  }
  state_->view.write_view();
}

std::vector<std::string> Store::parameter_names() const {
  Statement statement(state_->database, "SELECT name FROM columns WHERE kind = 'parameter' ORDER BY name");
  std::vector<std::string> names;
  while (statement.step())
    names.push_back(statement.text(0));
  return names;
}

}  // namespace pellucid::sweeps
