#include "sweeps/spec/clock.hpp"

#include <algorithm>
#include <atomic>
#include <ctime>

namespace pellucid::sweeps {
namespace {

double read_clock(clockid_t clock) {
  struct timespec time {};
  ::clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double clock_difference() {
  return read_clock(CLOCK_REALTIME) - read_clock(CLOCK_BOOTTIME);
}

std::atomic<double>& kept_difference() {
  static std::atomic<double> difference = clock_difference();
  return difference;
}

}  // namespace

// CLOCK_BOOTTIME goes on while the machine sleeps, and nobody can set it.
double unix_now_s() {
  return kept_difference() + read_clock(CLOCK_BOOTTIME);
}

double unix_minus_boot_s() {
  return kept_difference();
}
void keep_unix_minus_boot_s(double difference) {
  kept_difference() = difference;
}

double clock_set_by_s() {
  return clock_difference() - kept_difference();
}

double SleepWatch::slept_s() {
  const double before = read_clock(CLOCK_MONOTONIC);
  const double boot = read_clock(CLOCK_BOOTTIME);
  const double after = read_clock(CLOCK_MONOTONIC);
  // This thread may have waited between two readings: the difference lies between these.
  const double least = boot - after;
  const double most = boot - before;
  if (!known_) known_ = most;
  const double slept = least - *known_;
  if (slept <= kLeast_s) {
    known_ = std::min(*known_, most);
    return 0;
  }
  known_ = most;
  return slept;
}

}  // namespace pellucid::sweeps
