#pragma once

#include <array>

#include "sweeps/bench.hpp"
#include "sweeps/frame_clock.hpp"

namespace pellucid::sweeps {

/// Times the method, the bare shader and what both share, in turn, at least `frames` of each, and fills in the times
/// and ratios.
void time_subjects(const std::array<FrameClock::Draw, 3>& subjects, int frames, BenchResult& result);

}  // namespace pellucid::sweeps
