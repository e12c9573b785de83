#include <chrono>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sweeps/spec/point_json.hpp"
#include "sweeps/workers/one_worker.hpp"
#include "sweeps/workers/run.hpp"
#include "sweeps/workers/worker_client.hpp"
#include "sweeps/workers/worker_protocol.hpp"

namespace pellucid::sweeps {
namespace {

/// Points that agree in this have one reference. Some that differ may have one too; the cache knows.
std::string reference_of(const Point& point) {
  std::string key = fmt::format("{} {} {}x{} {}", point.scene, point.view, point.size.width, point.size.height,
                                to_json(point.reference).dump());
  for (const auto& [name, value] : point.parameters) {
    const bool counts = name.starts_with("scene.") || name.starts_with("frame.") || name.starts_with("shadow.");
    if (counts) key += fmt::format(" {}={}", name, to_text(value));
  }
  return key;
}

}  // namespace

ReferencesSummary trace_references(const Spec& spec, const Plan& plan, const std::filesystem::path& folder,
                                   const RunOptions& options) {
  std::vector<const Point*> points;
  std::set<std::string> seen;
  for (const Point& point : plan.points) {
    if (!point.metrics.empty() && seen.insert(reference_of(point)).second) points.push_back(&point);
  }
  ReferencesSummary summary;
  summary.planned = points.size();
  OneWorker worker(spec, points.size(), options);
  const StopSignals& signals = worker.signals();
  for (const Point* point : points) {
    if (signals.caught() || signals.warned()) break;
    const std::string what =
        fmt::format("reference of {} {} {}x{}", point->scene, point->view, point->size.width, point->size.height);
    worker.progress().begin(what);
    const auto start = std::chrono::steady_clock::now();
    const WorkerClient::Answer answer = worker.ask(
        {{"type", "reference"}, {"point", point_to_json(*point)}, {"references", folder.string()}}, point->id);
    if (answer.outcome == WorkerClient::Outcome::stopped) break;
    const bool failed = answer.outcome == WorkerClient::Outcome::failed;
    if (failed) {
      summary.failures.push_back(answer.reason);
      worker.progress().note(fmt::format("failed: {}", answer.reason));
    } else {
      ++summary.done;
    }
    worker.progress().finish(what, failed ? "failed" : "done",
                             std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  summary.interrupted =
      signals.caught() || (signals.warned() && summary.done + summary.failures.size() < points.size());
  worker.close();
  return summary;
}

}  // namespace pellucid::sweeps
