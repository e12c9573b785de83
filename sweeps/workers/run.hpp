#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sweeps/spec/plan.hpp"
#include "sweeps/spec/shard.hpp"
#include "sweeps/spec/spec.hpp"

namespace pellucid::sweeps {

struct RunOptions {
  std::vector<int> devices;  ///< a worker for each; empty: one on the default device
  Shard shard{};
  std::optional<bool> timed;                        ///< only points with timing, or only those without
  std::vector<std::string> argv;                    ///< for the record; empty: this process's own
  std::size_t limit = 0;                            ///< measure at most so many points, then stop; 0: all
  std::size_t fail_after = 0;                       ///< stop when so many points have failed in this call; 0: never
  bool retry_failed = false;                        ///< measure points again that are recorded as failed
  bool quiet = false;                               ///< no progress on standard error
  std::vector<std::string> worker;                  ///< command of a worker; empty: this executable with `worker`
  std::optional<std::filesystem::path> references;  ///< folder of cached references; default STORE.references
};

struct SweepSummary {
  std::size_t planned = 0;               ///< distinct points, of this shard
  std::size_t reused = 0;                ///< were in the store already
  std::size_t measured = 0;              ///< rows made by this call with status "ok"
  std::size_t failed = 0;                ///< rows made by this call with status "failed"
  std::size_t unconverged = 0;           ///< of `measured`
  std::size_t left = 0;                  ///< not measured yet: interrupted or beyond `limit`
  bool interrupted = false;              ///< by SIGINT or SIGTERM, or by SIGUSR1 when the point in work was done
  bool gave_up = false;                  ///< `fail_after` points failed
  std::string device;                    ///< "DEVICE, DRIVER" of the rows; empty when there is none yet
  std::optional<double> baseline_drift;  ///< largest |drift| of the baseline's re-measurements over the first, relative
  double wall_s = 0;
};

/// Measures every point of `spec` that `store` does not hold, in worker processes; this process needs no GL and makes
/// none. Progress goes to standard error. Rows of other devices and drivers in the store stay, apart: a point is
/// measured once on each. Only when nothing is missing and no device is asked for is none looked at. The workers of one
/// call must be of one device and driver. Throws InputError for a store or spec that is wrong or for devices that
/// differ; RuntimeError when no worker can start or the store cannot be written.
SweepSummary run_sweep(const Spec&, const std::filesystem::path& store, const RunOptions& = {});
SweepSummary run_sweep(const Spec&, const Plan&, const std::filesystem::path& store, const RunOptions&);

struct ReferencesSummary {
  std::size_t planned = 0;  ///< distinct references
  std::size_t done = 0;     ///< traced, or in the folder already
  std::vector<std::string> failures;
  bool interrupted = false;
};

/// Traces the references of all points into a folder that several sweeps may share, so that none of them does.
ReferencesSummary trace_references(const Spec&, const Plan&, const std::filesystem::path& folder, const RunOptions&);

/// Frame times of `points` in turns, `rounds` times, by one worker: the medians of `frames` frames each [ms], by point
/// and round. Nothing is stored. Those of a point that cannot be timed are empty; all are when it is interrupted.
std::vector<std::vector<double>> time_in_turns(const Spec&, const std::vector<const Point*>& points, int rounds,
                                               int frames, const RunOptions&);

}  // namespace pellucid::sweeps
