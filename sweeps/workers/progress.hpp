#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>

namespace pellucid::sweeps {

/// "45 s", "3 min 12 s", "2 h 5 min"
std::string duration_text(double seconds);

/// A bar with the time left on a terminal, a plain line for each finished point elsewhere; on standard error.
class SweepProgress {
 public:
  /// `total` points, of which `done` are done; `expected_s` is a guess at one point's time until there is a measured
  /// one.
  /// `workers` points are in work at a time.
  SweepProgress(std::size_t total, std::size_t done, double expected_s, std::size_t workers, bool quiet);
  ~SweepProgress();
  SweepProgress(const SweepProgress&) = delete;
  SweepProgress& operator=(const SweepProgress&) = delete;

  void begin(std::string what);
  void phase(std::string_view name, double share);
  /// Redraws the clock; called a few times a second.
  void tick();
  void finish(std::string_view what, std::string_view outcome, double wall_s);
  /// A line of its own, above the bar.
  void note(std::string_view line);

 private:
  void draw();
  void clear();
  double each_s() const;
  std::size_t total_, done_, workers_;
  bool quiet_, terminal_;
  double expected_s_, measured_s_ = 0;
  std::size_t measured_ = 0;
  std::string what_, phase_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point point_start_, last_draw_;
};

}  // namespace pellucid::sweeps
