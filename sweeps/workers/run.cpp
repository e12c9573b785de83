#include "sweeps/workers/run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "sweeps/spec/point_json.hpp"
#include "sweeps/spec/provenance.hpp"
#include "sweeps/store/store.hpp"
#include "sweeps/workers/progress.hpp"
#include "sweeps/workers/stop_signals.hpp"
#include "sweeps/workers/worker_client.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;
using SteadyClock = std::chrono::steady_clock;

/// The baseline is measured again before a timed point when so many have been since.
constexpr std::size_t kBaselineEvery = 8;

double seconds_since(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

std::string describe(const Point& point) {
  std::string text = fmt::format("{} {}", point.technique, point.scene);
  for (const std::string& name : point.assigned)
    text += fmt::format(" {}={}", name, to_text(point.parameters.at(name)));
  return text + fmt::format(" {}x{}", point.size.width, point.size.height);
}

std::string outcome_text(const json& row) {
  std::string text;
  if (row.contains("frame_ms_median")) {
    text = fmt::format("{:.3g} ms", row.at("frame_ms_median").get<double>());
    if (row.value("timing", "") == "unconverged") text += " (unconverged)";
    if (const auto saturated = row.value("saturated_pixels", 0); saturated > 0)
      text += fmt::format(" ({} pixels saturate 16-bit floats)", saturated);
  }
  for (const char* metric : {"flip_mean", "rmse"}) {
    if (row.contains(metric))
      text += fmt::format("{}{} {:.3g}", text.empty() ? "" : ", ", metric, row.at(metric).get<double>());
  }
  return text.empty() ? "done" : text;
}

/// Why a row that a worker calls done is not; empty when it is sound.
std::string flaw(const json& row, const Point& point) {
  if (point.timing.enabled && !row.contains("frame_ms_median")) return "the worker gave no frame time";
  for (const auto& [name, value] : row.items()) {
    // JSON has no NaN: it arrives as null. Equal images have an infinite PSNR.
    if (value.is_null() && !name.starts_with("psnr")) return fmt::format("{} is not a finite number", name);
  }
  return "";
}

class Runner {
 public:
  Runner(const Spec& spec, const Plan& plan, const std::filesystem::path& path, const RunOptions& options)
      : spec_(spec),
        plan_(plan),
        path_(path),
        options_(options),
        argv_(shell_line(options.argv.empty() ? process_argv() : options.argv)),
        store_(path, Access::write),
        references_(options.references.value_or(path.string() + ".references")),
        client_(options.worker, options.device, spec.timeout_s) {}

  SweepSummary run() {
    const auto start = SteadyClock::now();
    store_.put_plan(spec_, plan_);
    const std::vector<std::size_t> pending = choose();
    if (!pending.empty()) measure_all(pending);
    for (const BaselineSample& sample : store_.baselines(spec_.name)) {
      if (!baseline_first_) baseline_first_ = sample.frame_ms_median;
      const double drift = std::abs(sample.frame_ms_median / *baseline_first_ - 1);
      summary_.baseline_drift = std::max(summary_.baseline_drift.value_or(0), drift);
    }
    summary_.left = summary_.planned - summary_.reused - summary_.measured - summary_.failed;
    summary_.wall_s = seconds_since(start);
    return summary_;
  }

 private:
  /// The points that are still to be measured, in the plan's order.
  std::vector<std::size_t> choose() {
    std::map<std::string, StoredPoint> stored;
    for (StoredPoint& point : store_.points())
      stored.emplace(point.id, std::move(point));
    std::set<std::string> other_commits;
    std::size_t other_rows = 0;
    std::vector<std::size_t> pending;
    double known_s = 0;
    for (const std::size_t index : plan_.order) {
      const auto found = stored.find(plan_.points[index].id);
      if (found == stored.end() || (found->second.failed && options_.retry_failed)) {
        pending.push_back(index);
        continue;
      }
      ++summary_.reused;
      known_s += found->second.wall_s;
      if (found->second.commit == kCommit || found->second.failed) continue;
      ++other_rows;
      other_commits.insert(found->second.commit.substr(0, 12));
    }
    for (const auto& [id, point] : stored) {
      if (!point.device.empty()) devices_.emplace(point.device, point.driver);
    }
    summary_.planned = plan_.points.size();
    if (summary_.reused > 0) expected_s_ = known_s / static_cast<double>(summary_.reused);
    if (!other_commits.empty() && !options_.quiet) {
      fmt::print(stderr, "warning: {} of the rows in '{}' were measured by another commit ({}); this is {}\n",
                 other_rows, path_.string(), fmt::join(other_commits, ", "), std::string(kCommit).substr(0, 12));
    }
    if (options_.limit > 0 && pending.size() > options_.limit) pending.resize(options_.limit);
    return pending;
  }

  void measure_all(const std::vector<std::size_t>& pending) {
    const StopSignals signals;
    SweepProgress progress(summary_.reused + pending.size(), summary_.reused, expected_s_, options_.quiet);
    progress_ = &progress;
    const WorkerClient::Hooks hooks{[&](const std::string& phase, double share) { progress.phase(phase, share); },
                                    [&] {
                                      progress.tick();
                                      return !signals.caught();
                                    }};
    for (const std::size_t index : pending) {
      const Point& point = plan_.points[index];
      if (signals.caught() || !ready(hooks)) break;
      if (point.timing.enabled && baseline_due()) measure_baseline(hooks);
      if (signals.caught() || !ready(hooks)) break;
      if (!measure(point, hooks)) break;
    }
    if (!signals.caught() && baseline_due_at_end() && ready(hooks)) measure_baseline(hooks);
    summary_.interrupted = signals.caught();
    if (!summary_.interrupted) client_.close();
    progress_ = nullptr;
  }

  /// A worker that has said hello; false when stopped meanwhile.
  bool ready(const WorkerClient::Hooks& hooks) {
    if (client_.running()) return true;
    progress_->begin("starting a worker");
    if (!client_.start(hooks)) return false;
    const WorkerClient::Hello& hello = client_.hello();
    for (const auto& [device, driver] : devices_) {
      if (device == hello.device && driver == hello.driver) continue;
      throw InputError(fmt::format(
          "store '{}' holds measurements of {} ({}), and this worker renders on {} ({}): times of different "
          "devices are not mixed; use another store or --device",
          path_.string(), device, driver, hello.device, hello.driver));
    }
    devices_.emplace(hello.device, hello.driver);
    return true;
  }

  bool baseline_due() const { return plan_.baseline && !baseline_broken_ && since_baseline_ >= kBaselineEvery; }
  bool baseline_due_at_end() const {
    return plan_.baseline && !baseline_broken_ && since_baseline_ > 0 && since_baseline_ != kNeverMeasured;
  }

  void measure_baseline(const WorkerClient::Hooks& hooks) {
    Point point = plan_.points[*plan_.baseline];
    point.timing.max_samples = point.timing.min_samples;
    progress_->begin("baseline " + describe(point));
    const WorkerClient::Answer answer =
        client_.ask({{"type", "time"}, {"point", point_to_json(point)}}, point.id, hooks);
    if (answer.outcome == WorkerClient::Outcome::stopped) return;
    if (answer.outcome == WorkerClient::Outcome::failed || !flaw(answer.row, point).empty()) {
      baseline_broken_ = true;
      progress_->note(
          fmt::format("warning: the baseline cannot be measured, so drift is not known: {}",
                      answer.outcome == WorkerClient::Outcome::failed ? answer.reason : flaw(answer.row, point)));
      return;
    }
    store_.put_baseline(spec_.name, {point.id, answer.row.value("timed_unix_s", unix_now_s()),
                                     answer.row.at("frame_ms_median").get<double>(), answer.frame_ms_samples});
    since_baseline_ = 0;
  }

  /// Measures a point and commits its row, whatever came of it; false when stopped meanwhile.
  bool measure(const Point& point, const WorkerClient::Hooks& hooks) {
    progress_->begin(describe(point));
    const double started = unix_now_s();
    const auto start = SteadyClock::now();
    json request{{"type", "measure"}, {"point", point_to_json(point)}, {"references", references_.string()}};
    WorkerClient::Answer answer = client_.ask(request, point.id, hooks);
    if (answer.outcome == WorkerClient::Outcome::stopped) return false;
    std::string failure = answer.outcome == WorkerClient::Outcome::failed ? answer.reason : flaw(answer.row, point);

    json row = failure.empty() ? std::move(answer.row) : json::object();
    const double wall_s = seconds_since(start);
    describe_row(row, point);
    row["status"] = failure.empty() ? "ok" : "failed";
    row["failure"] = failure;
    row["started_utc"] = utc_text(started);
    row["done_unix_s"] = unix_now_s();
    row["wall_s"] = wall_s;
    store_.put_row(point.id, row, failure.empty() ? answer.frame_ms_samples : std::vector<double>{});

    if (point.timing.enabled && since_baseline_ != kNeverMeasured) ++since_baseline_;
    if (!failure.empty()) {
      ++summary_.failed;
      progress_->note(fmt::format("failed: {}\n  repeat: {}", failure, repeat_command(point)));
    } else {
      ++summary_.measured;
      if (row.value("timing", "") == "unconverged") ++summary_.unconverged;
    }
    progress_->finish(failure.empty() ? outcome_text(row) : "failed", wall_s);
    return true;
  }

  /// What is known of a row without a worker.
  void describe_row(json& row, const Point& point) const {
    for (const auto& [name, value] : point.parameters)
      row[name] = value_to_json(value);
    row["technique"] = point.technique;
    row["scene"] = point.scene;
    row["view"] = point.view;
    row["width"] = point.size.width;
    row["height"] = point.size.height;
    row["repeat"] = repeat_command(point);
    row["device"] = client_.hello().device;
    row["driver"] = client_.hello().driver;
    if (!row.contains("clock")) row["clock"] = client_.hello().clock;
    if (!row.contains("scene_hash")) row["scene_hash"] = point.scene_hash;
    row["code_hash"] = point.code_hash;
    row["commit"] = kCommit;
    row["dirty"] = kDirty;
    row["argv"] = argv_;
  }

  static constexpr std::size_t kNeverMeasured = static_cast<std::size_t>(-1);  // in this call: due at once

  const Spec& spec_;
  const Plan& plan_;
  std::filesystem::path path_;
  const RunOptions& options_;
  std::string argv_;
  Store store_;
  std::filesystem::path references_;
  WorkerClient client_;
  SweepProgress* progress_ = nullptr;
  SweepSummary summary_;
  std::set<std::pair<std::string, std::string>> devices_;
  double expected_s_ = 0;
  std::size_t since_baseline_ = kNeverMeasured;
  bool baseline_broken_ = false;
  std::optional<double> baseline_first_;
};

}  // namespace

SweepSummary run_sweep(const Spec& spec, const Plan& plan, const std::filesystem::path& store,
                       const RunOptions& options) {
  return Runner(spec, plan, store, options).run();
}

SweepSummary run_sweep(const Spec& spec, const std::filesystem::path& store, const RunOptions& options) {
  return run_sweep(spec, make_plan(spec), store, options);
}

}  // namespace pellucid::sweeps
