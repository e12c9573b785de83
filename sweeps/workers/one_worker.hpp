#pragma once

#include <cstddef>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "sweeps/spec/spec.hpp"
#include "sweeps/workers/progress.hpp"
#include "sweeps/workers/run.hpp"
#include "sweeps/workers/stop_signals.hpp"
#include "sweeps/workers/worker_client.hpp"

namespace pellucid::sweeps {

/// One worker on the first of the devices, its progress on standard error and the signals that end it: for whoever asks
/// one thing after another and keeps no store.
class OneWorker {
 public:
  /// Starts nothing yet. `total` is what the progress counts to.
  OneWorker(const Spec&, std::size_t total, const RunOptions&);
  OneWorker(const OneWorker&) = delete;
  OneWorker& operator=(const OneWorker&) = delete;

  /// Starts a worker where none runs and asks it. `stopped` when a signal came, at the start too.
  WorkerClient::Answer ask(const nlohmann::json& request, const std::string& id);
  /// Lets the worker end by itself, unless a signal has ended it.
  void close();

  const StopSignals& signals() const { return signals_; }
  SweepProgress& progress() { return progress_; }

 private:
  StopSignals signals_;
  SweepProgress progress_;
  WorkerClient client_;
  WorkerClient::Hooks hooks_;
};

}  // namespace pellucid::sweeps
