#include <cstddef>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sweeps/spec/point_json.hpp"
#include "sweeps/workers/one_worker.hpp"
#include "sweeps/workers/point_row.hpp"
#include "sweeps/workers/run.hpp"
#include "sweeps/workers/worker_client.hpp"

namespace pellucid::sweeps {

std::vector<std::vector<double>> time_in_turns(const Spec& spec, const std::vector<const Point*>& points, int rounds,
                                               int frames, const RunOptions& options) {
  std::vector<std::vector<double>> times(points.size());
  std::vector<bool> broken(points.size(), false);
  OneWorker worker(spec, static_cast<std::size_t>(rounds), options);
  for (int round = 0; round < rounds; ++round) {
    const std::string what = fmt::format("{} finalists in turns", points.size());
    worker.progress().begin(what);
    double total_ms = 0;
    for (std::size_t turn = 0; turn < points.size(); ++turn) {
      // Back and forth, so that none always follows the same one.
      const std::size_t i = round % 2 == 0 ? turn : points.size() - 1 - turn;
      if (broken[i]) continue;
      Point point = *points[i];
      point.timing.min_samples = point.timing.max_samples = frames;
      const WorkerClient::Answer answer = worker.ask({{"type", "time"}, {"point", point_to_json(point)}}, point.id);
      if (answer.outcome == WorkerClient::Outcome::stopped) return std::vector<std::vector<double>>(points.size());
      const std::string wrong =
          answer.outcome == WorkerClient::Outcome::failed ? answer.reason : flaw_of(answer.row, point);
      if (wrong.empty()) {
        times[i].push_back(answer.row.at("frame_ms_median").get<double>());
        total_ms += times[i].back();
        continue;
      }
      broken[i] = true;
      times[i].clear();
      worker.progress().note(fmt::format("failed: {}: {}", summary_of(point), wrong));
    }
    worker.progress().finish(what, "done", total_ms / 1000);
  }
  worker.close();
  return times;
}

}  // namespace pellucid::sweeps
