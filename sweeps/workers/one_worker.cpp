#include "sweeps/workers/one_worker.hpp"

#include <optional>

#include <nlohmann/json.hpp>

namespace pellucid::sweeps {

OneWorker::OneWorker(const Spec& spec, std::size_t total, const RunOptions& options)
    : progress_(total, 0, 0, 1, options.quiet),
      client_(options.worker, options.devices.empty() ? std::nullopt : std::optional(options.devices.front()),
              spec.timeout_s),
      hooks_{[this](const std::string& phase, double share) { progress_.phase(phase, share); },
             [this] {
               progress_.tick();
               return !signals_.caught();
             },
             [this](const std::string& line) { progress_.note(line); }} {}

WorkerClient::Answer OneWorker::ask(const nlohmann::json& request, const std::string& id) {
  if (!client_.running() && !client_.start(hooks_)) {
    WorkerClient::Answer none;
    none.outcome = WorkerClient::Outcome::stopped;
    return none;
  }
  return client_.ask(request, id, hooks_);
}

void OneWorker::close() {
  if (!signals_.caught()) client_.close();
}

}  // namespace pellucid::sweeps
