#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "sweeps/spec/plan.hpp"

/// Results of sweeps: one SQLite file. A row is committed when its point is done. On a disk of this machine the file is
/// in WAL mode; on a file system that several machines share it has a rollback journal and one user at a time.
namespace pellucid::sweeps {

inline constexpr int kSchemaVersion = 2;

/// A frame-time measurement of the baseline between points.
struct BaselineSample {
  std::string point;
  double unix_s = 0;
  double frame_ms_median = 0;
  std::vector<double> frame_ms_samples;
  std::string device{}, driver{}, host{};  ///< empty in a store of version 1, which has one device
};

/// Which measurements a store holds of one block, on one device where it holds several.
struct BlockStatus {
  std::string sweep, block;
  std::size_t planned = 0, done = 0, failed = 0;
  std::string device{};  ///< "DEVICE, DRIVER"; empty while the store knows none
  std::size_t left() const { return planned - done - failed; }
};

/// One call of `sweep run`, and where its wall time went.
struct RunRecord {
  std::string sweep, host, device, driver, shard;
  double started_unix_s = 0;
  double wall_s = 0;
  double measuring_s = 0;  ///< workers drew, timed and compared; of several workers their mean
  double starting_s = 0;   ///< workers started
  double storing_s = 0;    ///< rows were stored
  std::size_t points = 0;
};

/// The meaning of a row's field, for the table `columns`.
struct ColumnMeaning {
  std::string unit, description;
};

/// A row as it stands in the file.
struct StoredRow {
  std::string id, device, driver;
  bool failed = false;
  double done_unix_s = 0;
  std::string row;  ///< a JSON object
  std::vector<double> frame_ms_samples;
};

/// A sweep's current plan as it stands in the file.
struct StoredPlan {
  std::string name, title, source, spec;
  std::vector<std::pair<std::string, std::string>> members;  ///< block and point's id, in order
};

/// The facts about a point that has been measured or has failed, on one device.
struct StoredPoint {
  std::string id;
  bool failed = false;
  std::string technique, code_hash;    ///< the hash is empty in rows of versions that did not know it
  std::string device, driver, commit;  ///< empty for a point that failed before its worker said hello
  double wall_s = 0, done_unix_s = 0;
};

enum class Access { read, write };

/// An open store. Errors: InputError when the file is missing (read), not a store, or of another schema version;
/// RuntimeError when the disk is full, the file cannot be written, or another sweep is writing it.
class Store {
 public:
  Store(const std::filesystem::path&, Access);
  ~Store();
  Store(Store&&) noexcept;
  Store& operator=(Store&&) noexcept;

  /// Makes `plan` the current plan of `spec`: its members replace those of an earlier plan of that name. Rows stay.
  void put_plan(const Spec&, const Plan&);
  /// Commits a point's row and its frame times, in place of an earlier one of the same device and driver. `row` is flat
  /// (README.md); its `status` is "ok" or "failed", its `device` and `driver` say whose times it holds.
  void put_row(const std::string& point, const nlohmann::json& row, std::span<const double> frame_ms_samples);
  void put_baseline(const std::string& sweep, const BaselineSample&);
  /// Told before rows are put: what their results mean. Parameters are known from the plan.
  void explain(std::map<std::string, ColumnMeaning> meanings);
  void remove_point(const std::string& point);
  /// Adds a run and gives its number; update_run() brings its times and points up to date.
  std::int64_t add_run(const RunRecord&);
  void update_run(std::int64_t id, const RunRecord&);

  // Merging needs these (merge.hpp): everything as it stands in the file. The second calls write within
  // `all_or_nothing`.
  std::vector<StoredPlan> plans() const;
  void put(const StoredPlan&, int rank);
  void each_row(const std::function<void(const StoredRow&)>&) const;
  std::optional<StoredRow> find(const std::string& id, const std::string& device, const std::string& driver) const;
  void put(const StoredRow&);
  std::vector<std::pair<std::string, BaselineSample>> all_baselines() const;
  void put(const RunRecord&);
  void copy_columns(const Store&);
  void note_columns(const nlohmann::json& row);
  void all_or_nothing(const std::function<void()>&);

  std::vector<StoredPoint> points() const;
  std::vector<double> samples(const std::string& point) const;  ///< of one device, where there are several
  std::vector<RunRecord> runs() const;
  /// The sweep's latest baseline point, in order of time, whatever the device.
  std::vector<BaselineSample> baselines(const std::string& sweep) const;
  std::vector<BlockStatus> status() const;
  /// Text of the spec that was last run under this name.
  std::optional<std::string> spec_text(const std::string& sweep) const;
  /// `all`: rows of earlier plans too, each once, without `sweep` and `block`.
  std::vector<nlohmann::json> rows(bool with_samples, bool all = false) const;
  /// Names of parameters among the rows' fields, as plans told them; empty in a store of version 1.
  std::vector<std::string> parameter_names() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The rows of every sweep's current plan, in the order of its spec: one flat object for each place in a block whose
/// point has been measured or has failed, and for each device that it was measured on. Adds `sweep`, `block` and
/// `baseline_drift`; with `with_samples` also `frame_ms_samples`. Numbers that do not exist (psnr of equal images, all
/// of a failed row) are null or absent.
std::vector<nlohmann::json> read_rows(const std::filesystem::path&, bool with_samples = false);

}  // namespace pellucid::sweeps
