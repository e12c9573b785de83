#pragma once

#include <array>
#include <span>
#include <vector>

#include "sweeps/bench.hpp"
#include "sweeps/bench_reference.hpp"
#include "sweeps/frame_clock.hpp"

namespace pellucid::sweeps {

/// Draws the subjects in turn in blocks of BenchResult::kBlockFrames, at least `frames` of each, and between one
/// subject and the next once a block has `reference`, if any, trace a picture. Returns the subjects' times [ms].
std::vector<std::vector<double>> time_in_turn(std::span<const FrameClock::Draw> subjects, int frames, FrameClock& clock,
                                              ReferenceTracer* reference);

/// Times the method, the bare shader and what both share, and with `reference` the reference, and fills in the times
/// and ratios.
void time_subjects(const std::array<FrameClock::Draw, 3>& subjects, int frames, ReferenceTracer* reference,
                   BenchResult& result);

/// Throws InputError for fewer frames than have an interval.
void check_frames(const BenchRequest&);

}  // namespace pellucid::sweeps
