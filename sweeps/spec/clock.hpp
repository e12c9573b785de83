#pragma once

#include <optional>

/// Clocks that can be set, and machines that sleep.
namespace pellucid::sweeps {

/// Seconds since 1970, as the machine's clock said when this process first asked and counted on since: a clock that is
/// set while a sweep runs moves none of its times.
double unix_now_s();

/// By how much the machine's clock has been set since then [s]; small values are adjustments of the network's time.
double clock_set_by_s();

/// The difference of unix_now_s() and CLOCK_BOOTTIME [s]: a worker takes over that of its parent, so that their times
/// agree.
double unix_minus_boot_s();
void keep_unix_minus_boot_s(double difference);

/// Notices that the machine was suspended: CLOCK_BOOTTIME goes on then and CLOCK_MONOTONIC, by which frames are timed,
/// does not.
class SleepWatch {
 public:
  SleepWatch() { slept_s(); }
  /// How long the machine slept since the last call [s], at least; 0 if it did not.
  double slept_s();

 private:
  static constexpr double kLeast_s = 1e-3;
  std::optional<double> known_;  // an upper bound of the clocks' difference
};

}  // namespace pellucid::sweeps
