#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "sweeps/measure/stopping.hpp"

/// Two runs of the same points, told apart where they differ by more than chance.
namespace pellucid::sweeps {

enum class TimeChange { untimed, same, undecided, faster, slower };
enum class QualityChange { unknown, same, better, worse };
const char* name(TimeChange);
const char* name(QualityChange);

struct ComparedPoint {
  std::string point;  ///< what it is: "volume_slices fog_forest default_view 720x540 slices=64"
  std::string device;
  TimeChange time = TimeChange::untimed;
  double ratio = 1;               ///< median of B over that of A
  std::optional<Interval> range;  ///< of the ratio, at the corrected confidence; nothing with too few samples
  QualityChange quality = QualityChange::unknown;
  std::map<std::string, std::pair<double, double>> metrics;  ///< of A and B, those that differ
  bool regression = false;
};

struct CompareOptions {
  double alpha = 0.05;       ///< chance that any of the points is called different where none is
  double tolerance = 0.02;   ///< a change beyond this is a regression; a ratio known to lie within it is "same"
  bool between_runs = true;  ///< intervals are widened by how much runs of the same code differ
  /// Errors to judge quality by; empty: every metric that both rows have. Less is better, but for psnr and ssim.
  std::vector<std::string> metrics;
};

struct RowComparison {
  std::vector<ComparedPoint> points;
  std::size_t only_in_a = 0, only_in_b = 0;  ///< points without a partner, failed ones included
  double confidence = 0;                     ///< of each point's interval, corrected for their number (Šidák 1967)
  /// Standard deviation of the logarithm of a median between two measurements of the same thing, beyond what the
  /// samples of one tell: from the baseline's re-measurements, or from the points themselves where they are many.
  double between_runs = 0;
  std::size_t count(TimeChange) const;
  std::size_t count(QualityChange) const;
  std::size_t regressions() const;
};

/// `a` and `b`: rows with their samples (Store::rows), matched by technique, scene, view, size and the fields named in
/// `parameters`; by device and driver too where either side has several. `baselines_*`: medians of the baseline's
/// re-measurements in each, in order.
RowComparison compare_rows(const std::vector<nlohmann::json>& a, const std::vector<nlohmann::json>& b,
                           const std::vector<std::string>& parameters, const std::vector<double>& baselines_a,
                           const std::vector<double>& baselines_b, const CompareOptions&);

/// The parameters among the fields of rows whose store does not say: those that the techniques declare, and all with
/// the prefixes of scenes and common settings.
std::vector<std::string> guess_parameters(const std::vector<nlohmann::json>& rows);

}  // namespace pellucid::sweeps
