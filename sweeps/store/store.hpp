#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "sweeps/spec/plan.hpp"

/// Results of sweeps: one SQLite file in WAL mode. A row is committed when its point is done.
namespace pellucid::sweeps {

inline constexpr int kSchemaVersion = 1;

/// A frame-time measurement of the baseline between points.
struct BaselineSample {
  std::string point;
  double unix_s = 0;
  double frame_ms_median = 0;
  std::vector<double> frame_ms_samples;
};

/// Which measurements a store holds of one block.
struct BlockStatus {
  std::string sweep, block;
  std::size_t planned = 0, done = 0, failed = 0;
  std::size_t left() const { return planned - done - failed; }
};

/// What is known of a point that has been measured or has failed.
struct StoredPoint {
  std::string id;
  bool failed = false;
  std::string technique, code_hash;    ///< the hash is empty in rows of versions that did not know it
  std::string device, driver, commit;  ///< empty for a point that failed before its worker said hello
  double wall_s = 0;
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
  /// Commits a point's row and its frame times. `row` is flat (README.md); its `status` is "ok" or "failed".
  void put_row(const std::string& point, const nlohmann::json& row, std::span<const double> frame_ms_samples);
  void put_baseline(const std::string& sweep, const BaselineSample&);
  void remove_point(const std::string& point);

  std::vector<StoredPoint> points() const;
  std::vector<double> samples(const std::string& point) const;
  /// Of the sweep's latest baseline point, in order of time.
  std::vector<BaselineSample> baselines(const std::string& sweep) const;
  std::vector<BlockStatus> status() const;
  /// Text of the spec that was last run under this name.
  std::optional<std::string> spec_text(const std::string& sweep) const;
  std::vector<nlohmann::json> rows(bool with_samples) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The rows of every sweep's current plan, in the order of its spec: one flat object for each place in a block whose
/// point has been measured or has failed. Adds `sweep`, `block` and `baseline_drift`; with `with_samples` also
/// `frame_ms_samples`. Numbers that do not exist (psnr of equal images, all of a failed row) are null or absent.
std::vector<nlohmann::json> read_rows(const std::filesystem::path&, bool with_samples = false);

}  // namespace pellucid::sweeps
