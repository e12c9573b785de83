#pragma once

#include <atomic>

namespace pellucid::sweeps::test {

/// Seconds that are added to this process's clocks, as if somebody had set them or the machine had slept: the C
/// library's clock_gettime() is replaced in this program (adversity_test.cpp).
struct ClockOffsets {
  std::atomic<double> realtime_s{0}, monotonic_s{0}, boot_s{0};
};
ClockOffsets& clock_offsets();

}  // namespace pellucid::sweeps::test
