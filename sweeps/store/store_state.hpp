#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "sweeps/store/sqlite.hpp"
#include "sweeps/store/store.hpp"
#include "sweeps/store/store_lock.hpp"
#include "sweeps/store/store_schema.hpp"

/// The state of an open store. For store.cpp and store_contents.cpp alone.
namespace pellucid::sweeps {

inline std::vector<double> read_reals(const Statement& statement, int column) {
  std::vector<double> values(statement.bytes(column) / sizeof(double));
  statement.read(column, values);
  return values;
}

struct Store::State {
  std::filesystem::path path;
  std::unique_ptr<WriteLock> lock;
  Database database;
  ResultsView view{database};
  bool inside = false;  // of all_or_nothing()
  bool shared = false;  // with other machines
  bool syncing = true;
  std::chrono::steady_clock::time_point synced{};

  State(const std::filesystem::path& p, Access access)
      : path(p),
        lock(access == Access::write ? std::make_unique<WriteLock>(p) : nullptr),
        database(p, access == Access::write ? Database::Mode::create : Database::Mode::read) {
    if (access == Access::read) {
      check_schema(database, path);
      present_as_current(database);
      return;
    }
    shared = on_network_file_system(path);
    if (shared) database.run("PRAGMA locking_mode = EXCLUSIVE;");  // before anything is read
    const bool empty =
        database.integer("SELECT count(*) FROM sqlite_master") == 0 && database.integer("PRAGMA application_id") == 0;
    if (!empty) check_schema(database, path);
    database.run(shared ? "PRAGMA journal_mode = TRUNCATE; PRAGMA synchronous = FULL;"
                        : "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;");
    if (empty) {
      create_schema(database);
    } else {
      migrate_schema(database);
    }
  }

  /// Waits for the disk once a second at most: the log's order is kept, so that a killed process loses nothing and a
  /// power cut that second. Small points would spend their time waiting.
  void choose_sync() {
    const auto now = std::chrono::steady_clock::now();
    const bool due = shared || now - synced >= std::chrono::seconds(1);
    if (due) synced = now;
    if (due == syncing) return;
    syncing = due;
    database.run(due ? "PRAGMA synchronous = FULL;" : "PRAGMA synchronous = NORMAL;");
  }

  /// Runs `f` in a transaction of its own, or in the one under way.
  template <class F>
  void commit(const F& f) {
    lock->check();
    if (inside) return f();
    choose_sync();
    Transaction transaction(database);
    f();
    transaction.commit();
  }

  nlohmann::json parse_row(const std::string& text, const std::string& point) const {
    nlohmann::json row = nlohmann::json::parse(text, nullptr, false);
    if (!row.is_object()) {
      throw InputError(fmt::format("store '{}' is damaged: the row of point {} is not JSON", path.string(), point));
    }
    return row;
  }
};

}  // namespace pellucid::sweeps
