#include "sweeps/store/store.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "sweeps/store/store_state.hpp"

namespace pellucid::sweeps {
namespace {

/// Change of the baseline over its first measurement, linear between the measurements around `unix_s`.
std::optional<double> drift_at(const std::vector<BaselineSample>& all, const nlohmann::json& row) {
  const double unix_s = row.value("timed_unix_s", 0.0);
  // Another device's baseline says nothing of this row, nor another machine's. Earlier rows do not name their host.
  const auto same = [&](const char* field, const std::string& of_baseline) {
    return of_baseline.empty() || !row.contains(field) || row.value(field, "") == of_baseline;
  };
  std::vector<BaselineSample> baselines;
  std::copy_if(all.begin(), all.end(), std::back_inserter(baselines), [&](const BaselineSample& b) {
    return same("device", b.device) && same("driver", b.driver) && same("host", b.host);
  });
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

Store::Store(const std::filesystem::path& path, Access access) {
  // SQLite's own names for stores that are gone when they are closed.
  if (const std::string name = path.string(); name.empty() || name == ":memory:" || name.starts_with("file:"))
    throw InputError(
        fmt::format("store '{}' would forget its rows; give a file's name (./{} for one called so)", name, name));
  if (access == Access::write) {
    // Beside it lie its journal and its folder of references, whose names are longer; a name has 255 bytes at most.
    constexpr std::size_t kLongest = 255 - std::string_view(".references").size();
    if (const std::size_t length = path.filename().string().size(); length > kLongest)
      throw InputError(
          fmt::format("store '{}': its name has {} bytes; {} are possible", path.string(), length, kLongest));
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
  StoredPlan stored{spec.name, spec.title, spec.source, spec.text, {}};
  for (const Member& member : plan.members)
    stored.members.emplace_back(member.block, plan.points[member.point].id);
  state_->commit([&] {
    const Database& db = state_->database;
    Statement rank(db, "SELECT rank FROM sweeps WHERE name = ?1");
    const bool known = rank.bind(1, spec.name).step();
    put(stored, static_cast<int>(known ? rank.integer(0) : db.integer("SELECT count(*) FROM sweeps")));
    state_->view.describe(plan);
  });
}

void Store::put_row(const std::string& point, const nlohmann::json& row, std::span<const double> frame_ms_samples) {
  const StoredRow stored{point,
                         row.value("device", ""),
                         row.value("driver", ""),
                         row.value("status", "") != "ok",
                         row.value("done_unix_s", 0.0),
                         dump(row),
                         {frame_ms_samples.begin(), frame_ms_samples.end()}};
  state_->commit([&] {
    put(stored);
    state_->view.add(row);
  });
}

void Store::put_baseline(const std::string& sweep, const BaselineSample& sample) {
  state_->commit([&] {
    Statement(state_->database,
              "INSERT INTO baselines(sweep, point, unix_s, frame_ms_median, frame_ms, device, driver, host) "
              "VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)")
        .bind(1, sweep)
        .bind(2, sample.point)
        .bind(3, sample.unix_s)
        .bind(4, sample.frame_ms_median)
        .bind(5, std::span<const double>(sample.frame_ms_samples))
        .bind(6, sample.device)
        .bind(7, sample.driver)
        .bind(8, sample.host)
        .step();
  });
}

void Store::remove_point(const std::string& point) {
  state_->commit([&] { Statement(state_->database, "DELETE FROM points WHERE id = ?1").bind(1, point).step(); });
}

std::vector<StoredPoint> Store::points() const {
  std::vector<StoredPoint> result;
  Statement statement(
      state_->database,
      "SELECT id, failed, json_extract(row, '$.technique'), json_extract(row, '$.code_hash'), device, driver, "
      "json_extract(row, '$.commit'), json_extract(row, '$.wall_s'), done_unix_s "
      "FROM points WHERE json_valid(row) ORDER BY id, device, driver");
  while (statement.step()) {
    result.push_back({statement.text(0), statement.integer(1) != 0, statement.text(2), statement.text(3),
                      statement.text(4), statement.text(5), statement.text(6), statement.real(7), statement.real(8)});
  }
  return result;
}

std::vector<double> Store::samples(const std::string& point) const {
  Statement statement(state_->database, "SELECT frame_ms FROM points WHERE id = ?1 ORDER BY device, driver");
  statement.bind(1, point);
  return statement.step() ? read_reals(statement, 0) : std::vector<double>{};
}

std::vector<BaselineSample> Store::baselines(const std::string& sweep) const {
  std::vector<BaselineSample> result;
  for (auto& [of, sample] : all_baselines()) {
    if (of == sweep) result.push_back(std::move(sample));
  }
  // A spec whose baseline has changed starts a new series.
  if (!result.empty()) {
    const std::string current = result.back().point;
    std::erase_if(result, [&](const BaselineSample& b) { return b.point != current; });
  }
  return result;
}

std::vector<BlockStatus> Store::status() const {
  const Database& db = state_->database;
  std::vector<std::pair<std::string, std::string>> devices;
  Statement names(db, "SELECT DISTINCT device, driver FROM points WHERE device <> '' ORDER BY device, driver");
  while (names.step())
    devices.emplace_back(names.text(0), names.text(1));
  const bool several = devices.size() > 1;
  if (devices.empty()) devices.emplace_back();
  Statement statement(
      db,
      "SELECT m.sweep, m.block, count(*), count(p.id) - coalesce(sum(p.failed), 0), coalesce(sum(p.failed), 0) "
      "FROM members m JOIN sweeps s ON s.name = m.sweep LEFT JOIN points p ON p.id = m.point "
      "AND (p.device = '' OR p.device = ?1 AND p.driver = ?2) "
      "GROUP BY m.sweep, m.block ORDER BY s.rank, min(m.rank)");
  std::vector<BlockStatus> result;
  for (const auto& [device, driver] : devices) {
    statement.bind(1, device).bind(2, driver);
    while (statement.step()) {
      const auto count = [&](int column) { return static_cast<std::size_t>(statement.integer(column)); };
      const bool none = several && count(3) + count(4) == 0;  // a sweep that never ran on this device
      if (none) continue;
      result.push_back({statement.text(0), statement.text(1), count(2), count(3), count(4),
                        device.empty() ? "" : device + ", " + driver});
    }
    statement.reset();
  }
  return result;
}

std::optional<std::string> Store::spec_text(const std::string& sweep) const {
  Statement statement(state_->database, "SELECT spec FROM sweeps WHERE name = ?1");
  statement.bind(1, sweep);
  if (!statement.step()) return std::nullopt;
  return statement.text(0);
}

std::vector<nlohmann::json> Store::rows(bool with_samples, bool all) const {
  Statement statement(
      state_->database,
      all ? "SELECT '', '', id, row, frame_ms FROM points ORDER BY id, device, driver"
          : "SELECT m.sweep, m.block, p.id, p.row, p.frame_ms FROM members m JOIN sweeps s ON s.name = m.sweep "
            "JOIN points p ON p.id = m.point ORDER BY s.rank, m.rank, p.device, p.driver");
  std::map<std::string, std::vector<BaselineSample>> baselines_of;
  std::vector<nlohmann::json> result;
  while (statement.step()) {
    nlohmann::json row = state_->parse_row(statement.text(3), statement.text(2));
    row["point"] = statement.text(2);
    if (with_samples) row["frame_ms_samples"] = read_reals(statement, 4);
    if (!all) {
      const std::string sweep = statement.text(0);
      const auto [known, is_new] = baselines_of.try_emplace(sweep);
      if (is_new) known->second = baselines(sweep);
      row["sweep"] = sweep;
      row["block"] = statement.text(1);
      const bool timed = row.value("timing", "off") != "off";
      const auto drift = timed ? drift_at(known->second, row) : std::nullopt;
      row["baseline_drift"] = drift ? nlohmann::json(*drift) : nlohmann::json();
    }
    result.push_back(std::move(row));
  }
  return result;
}

std::vector<nlohmann::json> read_rows(const std::filesystem::path& path, bool with_samples) {
  return Store(path, Access::read).rows(with_samples);
}

}  // namespace pellucid::sweeps
