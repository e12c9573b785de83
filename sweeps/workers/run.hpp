#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sweeps/spec/plan.hpp"
#include "sweeps/spec/spec.hpp"

namespace pellucid::sweeps {

struct RunOptions {
  std::optional<int> device;                        ///< `--device N` of the worker
  std::vector<std::string> argv;                    ///< for the record; empty: this process's own
  std::size_t limit = 0;                            ///< measure at most so many points, then stop; 0: all
  bool retry_failed = false;                        ///< measure points again that are recorded as failed
  bool quiet = false;                               ///< no progress on standard error
  std::vector<std::string> worker;                  ///< command of a worker; empty: this executable with `worker`
  std::optional<std::filesystem::path> references;  ///< folder of cached references; default STORE.references
};

struct SweepSummary {
  std::size_t planned = 0;               ///< distinct points
  std::size_t reused = 0;                ///< were in the store already
  std::size_t measured = 0;              ///< rows made by this call with status "ok"
  std::size_t failed = 0;                ///< rows made by this call with status "failed"
  std::size_t unconverged = 0;           ///< of `measured`
  std::size_t left = 0;                  ///< not measured yet: interrupted or beyond `limit`
  bool interrupted = false;              ///< by SIGINT or SIGTERM
  std::optional<double> baseline_drift;  ///< largest |drift| of the baseline's re-measurements over the first, relative
  double wall_s = 0;
};

/// Measures every point of `spec` that `store` does not hold, in worker processes; this process needs no GL and makes
/// none. Progress goes to standard error. Throws InputError for a store or spec that is wrong, or a store with timings
/// of another device or driver; RuntimeError when no worker can start or the store cannot be written.
SweepSummary run_sweep(const Spec&, const std::filesystem::path& store, const RunOptions& = {});
SweepSummary run_sweep(const Spec&, const Plan&, const std::filesystem::path& store, const RunOptions&);

}  // namespace pellucid::sweeps
