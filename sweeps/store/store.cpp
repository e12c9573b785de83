#include "sweeps/store/store.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <map>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "gl/error.hpp"
#include "sweeps/store/sqlite.hpp"

namespace pellucid::sweeps {
namespace {

constexpr int kApplicationId = 0x50454c43;  // "PELC"

// Rows are flat JSON objects: their columns are the parameters of whatever techniques there are. What queries need
// stands beside them.
constexpr const char* kSchema = R"(
CREATE TABLE sweeps(name TEXT PRIMARY KEY, title TEXT NOT NULL, source TEXT NOT NULL, spec TEXT NOT NULL, rank INTEGER NOT NULL);
CREATE TABLE points(id TEXT PRIMARY KEY, failed INTEGER NOT NULL, done_unix_s REAL NOT NULL, row TEXT NOT NULL, frame_ms BLOB NOT NULL);
CREATE TABLE members(sweep TEXT NOT NULL, rank INTEGER NOT NULL, block TEXT NOT NULL, point TEXT NOT NULL,
                     PRIMARY KEY(sweep, rank)) WITHOUT ROWID;
CREATE TABLE baselines(rank INTEGER PRIMARY KEY, sweep TEXT NOT NULL, point TEXT NOT NULL, unix_s REAL NOT NULL,
                       frame_ms_median REAL NOT NULL, frame_ms BLOB NOT NULL);
)";

/// One writer at a time: a lock on a file beside the store, gone with the process however it ends.
class WriteLock {
 public:
  explicit WriteLock(const std::filesystem::path& store) : path_(store.string() + "-lock") {
    for (;;) {
      file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
      if (file_ < 0) {
        throw RuntimeError(fmt::format("store '{}' cannot be written: {}", store.string(), std::strerror(errno)));
      }
      if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
        ::close(file_);
        throw RuntimeError(fmt::format("store '{}' is being written by another sweep", store.string()));
      }
      // Whoever held the lock before may have removed the file in between.
      struct stat here {};
      struct stat there {};
      if (::fstat(file_, &here) == 0 && ::stat(path_.c_str(), &there) == 0 && here.st_ino == there.st_ino) return;
      ::close(file_);
    }
  }
  ~WriteLock() {
    if (file_ < 0) return;
    ::unlink(path_.c_str());
    ::close(file_);
  }
  WriteLock(const WriteLock&) = delete;
  WriteLock& operator=(const WriteLock&) = delete;

 private:
  std::string path_;
  int file_ = -1;
};

std::vector<double> read_reals(const Statement& statement, int column) {
  std::vector<double> values(statement.bytes(column) / sizeof(double));
  statement.read(column, values);
  return values;
}

/// Change of the baseline over its first measurement, linear between the measurements around `unix_s`.
std::optional<double> drift_at(const std::vector<BaselineSample>& baselines, double unix_s) {
  if (baselines.empty()) return std::nullopt;
  const auto relative = [&](const BaselineSample& b) {
    return b.frame_ms_median / baselines.front().frame_ms_median - 1;
  };
  const auto after =
      std::find_if(baselines.begin(), baselines.end(), [&](const auto& b) { return b.unix_s >= unix_s; });
  if (after == baselines.begin()) return relative(*after);
  if (after == baselines.end()) return relative(baselines.back());
  const auto before = after - 1;
  const double span = after->unix_s - before->unix_s;
  const double t = span > 0 ? (unix_s - before->unix_s) / span : 0;
  return relative(*before) + t * (relative(*after) - relative(*before));
}

std::string dump(const nlohmann::json& row) {
  return row.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

struct Store::State {
  std::filesystem::path path;
  std::unique_ptr<WriteLock> lock;
  Database database;

  State(const std::filesystem::path& p, Access access)
      : path(p),
        lock(access == Access::write ? std::make_unique<WriteLock>(p) : nullptr),
        database(p, access == Access::write ? Database::Mode::create : Database::Mode::read) {
    if (access == Access::write && database.integer("SELECT count(*) FROM sqlite_master") == 0 && identity() == 0)
      create();
    check();
    if (access == Access::write) database.run("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;");
  }

  std::int64_t identity() const { return database.integer("PRAGMA application_id"); }

  void create() {
    database.run("PRAGMA journal_mode = WAL;");
    Transaction transaction(database);
    database.run(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {};", kApplicationId, kSchemaVersion));
    database.run(kSchema);
    transaction.commit();
  }

  void check() const {
    if (identity() != kApplicationId)
      throw InputError(fmt::format("store '{}' is not a Pellucid store", path.string()));
    const std::int64_t version = database.integer("PRAGMA user_version");
    if (version != kSchemaVersion) {
      throw InputError(
          fmt::format("store '{}' has schema version {}, and this program reads version {}; use the program that "
                      "made it, or another store",
                      path.string(), version, kSchemaVersion));
    }
  }

  nlohmann::json parse_row(const std::string& text, const std::string& point) const {
    nlohmann::json row = nlohmann::json::parse(text, nullptr, false);
    if (!row.is_object()) {
      throw InputError(fmt::format("store '{}' is damaged: the row of point {} is not JSON", path.string(), point));
    }
    return row;
  }
};

Store::Store(const std::filesystem::path& path, Access access) {
  // SQLite's own names for stores that are gone when they are closed.
  if (const std::string name = path.string(); name.empty() || name == ":memory:" || name.starts_with("file:"))
    throw InputError(
        fmt::format("store '{}' would forget its rows; give a file's name (./{} for one called so)", name, name));
  if (access == Access::write) {
    std::error_code error;
    const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
    std::filesystem::create_directories(folder, error);
    if (error) {
      throw RuntimeError(fmt::format("folder '{}' cannot be made: {}", folder.string(), error.message()));
    }
    if (std::filesystem::is_directory(path, error)) {
      throw InputError(fmt::format("store '{}' is a folder", path.string()));
    }
  }
  state_ = std::make_unique<State>(path, access);
}
Store::~Store() = default;
Store::Store(Store&&) noexcept = default;
Store& Store::operator=(Store&&) noexcept = default;

void Store::put_plan(const Spec& spec, const Plan& plan) {
  Database& db = state_->database;
  Transaction transaction(db);
  Statement(db,
            "INSERT INTO sweeps VALUES(?1, ?2, ?3, ?4, (SELECT count(*) FROM sweeps)) ON CONFLICT(name) DO UPDATE SET "
            "title = ?2, source = ?3, spec = ?4")
      .bind(1, spec.name)
      .bind(2, spec.title)
      .bind(3, spec.source)
      .bind(4, spec.text)
      .step();
  Statement(db, "DELETE FROM members WHERE sweep = ?1").bind(1, spec.name).step();
  Statement insert(db, "INSERT INTO members VALUES(?1, ?2, ?3, ?4)");
  for (std::size_t i = 0; i < plan.members.size(); ++i) {
    insert.bind(1, spec.name)
        .bind(2, static_cast<std::int64_t>(i))
        .bind(3, plan.members[i].block)
        .bind(4, plan.points[plan.members[i].point].id)
        .step();
    insert.reset();
  }
  transaction.commit();
}

void Store::put_row(const std::string& point, const nlohmann::json& row, std::span<const double> frame_ms_samples) {
  Database& db = state_->database;
  Transaction transaction(db);
  Statement(db, "INSERT OR REPLACE INTO points VALUES(?1, ?2, ?3, ?4, ?5)")
      .bind(1, point)
      .bind(2, std::int64_t{row.value("status", "") != "ok"})
      .bind(3, row.value("done_unix_s", 0.0))
      .bind(4, dump(row))
      .bind(5, frame_ms_samples)
      .step();
  transaction.commit();
}

void Store::put_baseline(const std::string& sweep, const BaselineSample& sample) {
  Database& db = state_->database;
  Transaction transaction(db);
  Statement(db, "INSERT INTO baselines(sweep, point, unix_s, frame_ms_median, frame_ms) VALUES(?1, ?2, ?3, ?4, ?5)")
      .bind(1, sweep)
      .bind(2, sample.point)
      .bind(3, sample.unix_s)
      .bind(4, sample.frame_ms_median)
      .bind(5, std::span<const double>(sample.frame_ms_samples))
      .step();
  transaction.commit();
}

void Store::remove_point(const std::string& point) {
  Database& db = state_->database;
  Transaction transaction(db);
  Statement(db, "DELETE FROM points WHERE id = ?1").bind(1, point).step();
  transaction.commit();
}

std::vector<StoredPoint> Store::points() const {
  std::vector<StoredPoint> result;
  Statement statement(state_->database, "SELECT id, failed, row FROM points ORDER BY id");
  while (statement.step()) {
    StoredPoint point;
    point.id = statement.text(0);
    point.failed = statement.integer(1) != 0;
    const nlohmann::json row = state_->parse_row(statement.text(2), point.id);
    point.technique = row.value("technique", "");
    point.code_hash = row.value("code_hash", "");
    point.device = row.value("device", "");
    point.driver = row.value("driver", "");
    point.commit = row.value("commit", "");
    point.wall_s = row.value("wall_s", 0.0);
    result.push_back(std::move(point));
  }
  return result;
}

std::vector<double> Store::samples(const std::string& point) const {
  Statement statement(state_->database, "SELECT frame_ms FROM points WHERE id = ?1");
  statement.bind(1, point);
  return statement.step() ? read_reals(statement, 0) : std::vector<double>{};
}

std::vector<BaselineSample> Store::baselines(const std::string& sweep) const {
  Statement statement(
      state_->database,
      "SELECT point, unix_s, frame_ms_median, frame_ms FROM baselines WHERE sweep = ?1 ORDER BY unix_s");
  statement.bind(1, sweep);
  std::vector<BaselineSample> result;
  while (statement.step()) {
    result.push_back({statement.text(0), statement.real(1), statement.real(2), read_reals(statement, 3)});
  }
  // A spec whose baseline has changed starts a new series.
  if (!result.empty()) {
    const std::string current = result.back().point;
    std::erase_if(result, [&](const BaselineSample& b) { return b.point != current; });
  }
  return result;
}

std::vector<BlockStatus> Store::status() const {
  Statement statement(
      state_->database,
      "SELECT m.sweep, m.block, count(*), count(p.id) - coalesce(sum(p.failed), 0), coalesce(sum(p.failed), 0) "
      "FROM members m JOIN sweeps s ON s.name = m.sweep LEFT JOIN points p ON p.id = m.point "
      "GROUP BY m.sweep, m.block ORDER BY s.rank, min(m.rank)");
  std::vector<BlockStatus> result;
  while (statement.step()) {
    const auto count = [&](int column) { return static_cast<std::size_t>(statement.integer(column)); };
    result.push_back({statement.text(0), statement.text(1), count(2), count(3), count(4)});
  }
  return result;
}

std::optional<std::string> Store::spec_text(const std::string& sweep) const {
  Statement statement(state_->database, "SELECT spec FROM sweeps WHERE name = ?1");
  statement.bind(1, sweep);
  if (!statement.step()) return std::nullopt;
  return statement.text(0);
}

std::vector<nlohmann::json> Store::rows(bool with_samples) const {
  Statement statement(
      state_->database,
      "SELECT m.sweep, m.block, p.id, p.row, p.frame_ms FROM members m JOIN sweeps s ON s.name = m.sweep "
      "JOIN points p ON p.id = m.point ORDER BY s.rank, m.rank");
  std::map<std::string, std::vector<BaselineSample>> baselines_of;
  std::vector<nlohmann::json> result;
  while (statement.step()) {
    nlohmann::json row = state_->parse_row(statement.text(3), statement.text(2));
    const std::string sweep = statement.text(0);
    const auto [known, is_new] = baselines_of.try_emplace(sweep);
    if (is_new) known->second = baselines(sweep);
    row["point"] = statement.text(2);
    row["sweep"] = sweep;
    row["block"] = statement.text(1);
    const bool timed = row.value("timing", "off") != "off";
    const auto drift = timed ? drift_at(known->second, row.value("timed_unix_s", 0.0)) : std::nullopt;
    row["baseline_drift"] = drift ? nlohmann::json(*drift) : nlohmann::json();
    if (with_samples) row["frame_ms_samples"] = read_reals(statement, 4);
    result.push_back(std::move(row));
  }
  return result;
}

std::vector<nlohmann::json> read_rows(const std::filesystem::path& path, bool with_samples) {
  return Store(path, Access::read).rows(with_samples);
}

}  // namespace pellucid::sweeps
