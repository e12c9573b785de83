#include "sweeps/workers/run.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "algorithms/scene/files/tell.hpp"
#include "gl/error.hpp"
#include "sweeps/measure/quiet_lock.hpp"
#include "sweeps/quantities/quantities.hpp"
#include "sweeps/spec/clock.hpp"
#include "sweeps/spec/point_json.hpp"
#include "sweeps/spec/provenance.hpp"
#include "sweeps/store/store.hpp"
#include "sweeps/workers/point_row.hpp"
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
        quiet_file_(options.devices.size() > 1) {
    std::vector<std::optional<int>> devices(options.devices.begin(), options.devices.end());
    if (devices.empty()) devices.emplace_back();
    for (const std::optional<int>& device : devices)
      workers_.push_back(std::make_unique<Worker>(options.worker, device, spec.timeout_s, quiet_file_.path()));
  }

  SweepSummary run() {
    const auto start = SteadyClock::now();
    std::map<std::string, ColumnMeaning> meanings;
    for (const Quantity& quantity : quantities())
      meanings[quantity.name] = {quantity.unit, quantity.doc};
    store_.explain(std::move(meanings));
    store_.put_plan(spec_, plan_);
    for (const std::size_t index : plan_.order) {
      const Point& point = plan_.points[index];
      const bool wanted = !options_.timed || *options_.timed == point.timing.enabled;
      if (wanted && options_.shard.holds(point)) mine_.push_back(index);
    }
    summary_.planned = mine_.size();
    record_.host = host_name();
    double latest_s = 0;
    for (StoredPoint& point : store_.points()) {
      latest_s = std::max(latest_s, point.done_unix_s);
      if (!point.device.empty()) devices_.emplace(point.device, point.driver);
      stored_[point.id].push_back(std::move(point));
    }
    if (const double ahead_s = latest_s - unix_now_s(); ahead_s > kClockJump_s && !options_.quiet) {
      fmt::print(
          stderr,
          "warning: rows in '{}' are {} ahead of this machine's clock, which was set back or differs from another "
          "machine's; the baseline's drift is wrong for rows of times that both claim\n",
          path_.string(), duration_text(ahead_s));
    }
    // Whether a point is missing on a device is known once its worker has said hello; on the only one, at once.
    if (!options_.devices.empty() || devices_.size() > 1 || missing_on_the_only_device()) {
      measure_all(start);
    } else if (!devices_.empty()) {
      choose(*devices_.begin());
    } else {
      choose({});
    }
    for (const BaselineSample& sample : store_.baselines(spec_.name)) {
      if (sample.device != record_.device || sample.driver != record_.driver || sample.host != record_.host) continue;
      if (!baseline_first_) baseline_first_ = sample.frame_ms_median;
      const double drift = std::abs(sample.frame_ms_median / *baseline_first_ - 1);
      summary_.baseline_drift = std::max(summary_.baseline_drift.value_or(0), drift);
    }
    summary_.left = summary_.planned - summary_.reused - summary_.measured - summary_.failed;
    summary_.wall_s = seconds_since(start);
    return summary_;
  }

 private:
  static constexpr std::size_t kNeverMeasured = static_cast<std::size_t>(-1);  // in this call: due at once

  /// One worker process and what the parent keeps of it.
  struct Worker {
    WorkerClient client;
    std::size_t since_baseline = kNeverMeasured;
    bool baseline_broken = false;
    Worker(const std::vector<std::string>& command, std::optional<int> device, double timeout_s,
           const std::filesystem::path& quiet)
        : client(command, device, timeout_s, quiet) {}
  };

  bool missing_on_the_only_device() const {
    return std::any_of(mine_.begin(), mine_.end(), [&](std::size_t index) {
      const auto found = stored_.find(plan_.points[index].id);
      return found == stored_.end() || (found->second.front().failed && options_.retry_failed);
    });
  }

  /// Fills `pending_` with the points that are still to be measured on a device and driver, in the plan's order.
  void choose(const std::pair<std::string, std::string>& device) {
    if (!device.first.empty()) summary_.device = device.first + ", " + device.second;
    record_.device = device.first;
    record_.driver = device.second;
    std::set<std::string> other_commits;
    std::size_t other_rows = 0;
    double known_s = 0;
    for (const std::size_t index : mine_) {
      const StoredPoint* known = nullptr;
      if (const auto found = stored_.find(plan_.points[index].id); found != stored_.end()) {
        for (const StoredPoint& point : found->second) {
          if (point.device.empty() || (point.device == device.first && point.driver == device.second)) known = &point;
        }
      }
      if (known == nullptr || (known->failed && options_.retry_failed)) {
        pending_.push_back(index);
        continue;
      }
      ++summary_.reused;
      known_s += known->wall_s;
      if (known->commit == kCommit || known->failed) continue;
      ++other_rows;
      other_commits.insert(known->commit.substr(0, 12));
    }
    if (summary_.reused > 0) expected_s_ = known_s / static_cast<double>(summary_.reused);
    if (!other_commits.empty() && !options_.quiet) {
      tell("warning: {} of the rows in '{}' were measured by another commit ({}); this is {}", other_rows,
           path_.string(), fmt::join(other_commits, ", "), std::string(kCommit).substr(0, 12));
    }
    if (options_.limit > 0 && pending_.size() > options_.limit) pending_.resize(options_.limit);
  }

  void measure_all(SteadyClock::time_point start) {
    const StopSignals signals;
    signals_ = &signals;
    start_ = start;
    Worker& first = *workers_.front();
    {
      SweepProgress starting(0, 0, 0, 1, options_.quiet);
      progress_ = &starting;
      if (!ready(first)) {
        summary_.interrupted = true;
        return;
      }
    }
    const WorkerClient::Hello hello = first.client.hello();
    if (!devices_.empty() && !devices_.contains({hello.device, hello.driver}) && !options_.quiet) {
      tell("note: '{}' holds rows of {} ({}) too; those of {} ({}) are kept apart", path_.string(),
           devices_.begin()->first, devices_.begin()->second, hello.device, hello.driver);
    }
    choose({hello.device, hello.driver});
    record_.sweep = spec_.name;
    if (options_.shard.count > 1) record_.shard = fmt::format("{}/{}", options_.shard.index, options_.shard.count);
    record_.started_unix_s = unix_now_s();
    SweepProgress progress(summary_.reused + pending_.size(), summary_.reused, expected_s_, workers_.size(),
                           options_.quiet);
    progress_ = &progress;
    if (!pending_.empty()) {
      run_ = store_.add_run(record_);
      std::vector<std::thread> others;
      for (std::size_t i = 1; i < workers_.size(); ++i)
        others.emplace_back([this, i] { work(*workers_[i]); });
      work(first);
      for (std::thread& other : others)
        other.join();
      if (error_) std::rethrow_exception(error_);
      update_run(true);
    }
    summary_.interrupted = signals.caught() || (signals.warned() && next_ < pending_.size());
    if (!signals.caught()) first.client.close();
    progress_ = nullptr;
  }

  /// Takes points until there are none left, in a thread of its own for each worker but the first.
  void work(Worker& worker) {
    try {
      while (const Point* point = next_point()) {
        if (!ready(worker)) break;
        if (point->timing.enabled && baseline_due(worker)) measure_baseline(worker);
        if (stopping() || !ready(worker)) break;
        if (!measure(worker, *point)) break;
      }
      const bool due = plan_.baseline && !worker.baseline_broken && worker.since_baseline > 0 &&
                       worker.since_baseline != kNeverMeasured;
      if (!stopping() && due && ready(worker)) measure_baseline(worker);
      if (!stopping() && &worker != workers_.front().get()) worker.client.close();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      broken_ = true;
    }
  }

  const Point* next_point() {
    const std::lock_guard lock(mutex_);
    if (stopping() || signals_->warned() || given_up_ || next_ == pending_.size()) return nullptr;
    return &plan_.points[pending_[next_++]];
  }

  bool stopping() const { return signals_->caught() || broken_; }

  WorkerClient::Hooks hooks() {
    return {[this](const std::string& phase, double share) {
              const std::lock_guard lock(mutex_);
              progress_->phase(phase, share);
            },
            [this] {
              const std::lock_guard lock(mutex_);
              progress_->tick();
              watch_clock();
              return !stopping();
            },
            [this](const std::string& line) {
              const std::lock_guard lock(mutex_);
              progress_->note(line);
            }};
  }

  /// Tells when the machine's clock has been set; the rows' times go on as if it had not.
  void watch_clock() {
    const double set_by_s = clock_set_by_s();
    const double jump_s = set_by_s - clock_set_by_s_;
    if (std::abs(jump_s) < kClockJump_s) return;
    clock_set_by_s_ = set_by_s;
    progress_->note(
        fmt::format("note: the machine's clock was set {} by {}; the times of this sweep go on without the jump",
                    jump_s > 0 ? "forward" : "back", duration_text(std::abs(jump_s))));
  }

  void show(const std::string& what) {
    const std::lock_guard lock(mutex_);
    progress_->begin(what);
  }

  /// A worker that has said hello; false when stopped meanwhile.
  bool ready(Worker& worker) {
    if (worker.client.running()) return true;
    show("starting a worker");
    const auto start = SteadyClock::now();
    if (!worker.client.start(hooks())) return false;
    const std::lock_guard lock(mutex_);
    record_.starting_s += seconds_since(start);
    const WorkerClient::Hello& hello = worker.client.hello();
    const WorkerClient::Hello& first = workers_.front()->client.hello();
    if (&worker != workers_.front().get() && (hello.device != first.device || hello.driver != first.driver)) {
      throw InputError(
          fmt::format("the devices differ: {} ({}) and {} ({}); their times are not comparable, so give each kind a "
                      "run of its own, with the same store if you like",
                      first.device, first.driver, hello.device, hello.driver));
    }
    return true;
  }

  bool baseline_due(const Worker& worker) const {
    return plan_.baseline && !worker.baseline_broken && worker.since_baseline >= kBaselineEvery;
  }

  WorkerClient::Answer ask(Worker& worker, json request, const std::string& id) {
    const auto start = SteadyClock::now();
    request["unix_minus_boot_s"] = unix_minus_boot_s();
    WorkerClient::Answer answer = worker.client.ask(request, id, hooks());
    const std::lock_guard lock(mutex_);
    record_.measuring_s += seconds_since(start) / static_cast<double>(workers_.size());
    if (const auto slept = answer.row.find("slept_s"); slept != answer.row.end() && slept->is_number()) {
      progress_->note(fmt::format("note: the machine slept for {}; the frames under way then do not count",
                                  duration_text(slept->get<double>())));
    }
    return answer;
  }

  void measure_baseline(Worker& worker) {
    Point point = plan_.points[*plan_.baseline];
    point.timing.max_samples = point.timing.min_samples;
    show("baseline " + summary_of(point));
    const WorkerClient::Answer answer = ask(worker, {{"type", "time"}, {"point", point_to_json(point)}}, point.id);
    if (answer.outcome == WorkerClient::Outcome::stopped) return;
    const std::string wrong =
        answer.outcome == WorkerClient::Outcome::failed ? answer.reason : flaw_of(answer.row, point);
    const std::lock_guard lock(mutex_);
    if (!wrong.empty()) {
      worker.baseline_broken = true;
      progress_->note(fmt::format("warning: the baseline cannot be measured, so drift is not known: {}", wrong));
      return;
    }
    const WorkerClient::Hello& hello = worker.client.hello();
    store_.put_baseline(spec_.name, {point.id, answer.row.value("timed_unix_s", unix_now_s()),
                                     answer.row.at("frame_ms_median").get<double>(), answer.frame_ms_samples,
                                     hello.device, hello.driver, record_.host});
    worker.since_baseline = 0;
  }

  /// Measures a point and commits its row, whatever came of it; false when stopped meanwhile.
  bool measure(Worker& worker, const Point& point) {
    const std::string what = summary_of(point);
    show(what);
    const double started = unix_now_s();
    const auto start = SteadyClock::now();
    json request{{"type", "measure"}, {"point", point_to_json(point)}, {"references", references_.string()}};
    if (point.keep != Keep::nothing) request["picture"] = picture_path(path_, point).string();
    WorkerClient::Answer answer = ask(worker, request, point.id);
    if (answer.killed && !stopping()) {  // by somebody, or for want of memory: once more, with a fresh worker
      if (!ready(worker)) return false;
      show(what);
      answer = ask(worker, request, point.id);
    }
    if (answer.outcome == WorkerClient::Outcome::stopped) return false;
    std::string failure = answer.outcome == WorkerClient::Outcome::failed ? answer.reason : flaw_of(answer.row, point);

    json row = failure.empty() ? std::move(answer.row) : json::object();
    const double wall_s = seconds_since(start);
    put_point(row, point);
    put_machine(row, worker.client.hello(), record_.host);
    put_outcome(row, failure, started, wall_s);
    row["argv"] = argv_;

    const std::lock_guard lock(mutex_);
    const auto storing = SteadyClock::now();
    store_.put_row(point.id, row, failure.empty() ? answer.frame_ms_samples : std::vector<double>{});
    ++record_.points;
    record_.storing_s += seconds_since(storing);
    update_run(false);

    if (point.timing.enabled && worker.since_baseline != kNeverMeasured) ++worker.since_baseline;
    if (!failure.empty()) {
      ++summary_.failed;
      progress_->note(fmt::format("failed: {}\n  repeat: {}", failure, repeat_command(point)));
      if (options_.fail_after > 0 && summary_.failed >= options_.fail_after) given_up_ = summary_.gave_up = true;
    } else {
      ++summary_.measured;
      if (row.value("timing", "") == "unconverged") ++summary_.unconverged;
    }
    progress_->finish(what, failure.empty() ? outcome_of(row) : "failed", wall_s);
    return true;
  }

  /// Brings the record of this run up to date, every few seconds or when it ends.
  void update_run(bool last) {
    record_.wall_s = seconds_since(start_);
    if (!last && record_.wall_s < updated_s_ + kUpdateEvery_s) return;
    updated_s_ = record_.wall_s;
    store_.update_run(run_, record_);
  }

  static constexpr double kUpdateEvery_s = 5;
  static constexpr double kClockJump_s = 1;

  const Spec& spec_;
  const Plan& plan_;
  std::filesystem::path path_;
  const RunOptions& options_;
  std::string argv_;
  Store store_;
  std::filesystem::path references_;
  QuietFile quiet_file_;
  std::vector<std::unique_ptr<Worker>> workers_;
  std::vector<std::size_t> mine_, pending_;
  std::map<std::string, std::vector<StoredPoint>> stored_;
  std::set<std::pair<std::string, std::string>> devices_;  // in the store
  const StopSignals* signals_ = nullptr;
  double expected_s_ = 0;

  // Shared by the workers' threads, under the mutex.
  std::mutex mutex_;
  std::size_t next_ = 0;
  SweepProgress* progress_ = nullptr;
  SweepSummary summary_;
  RunRecord record_;
  std::int64_t run_ = 0;
  SteadyClock::time_point start_{};
  double updated_s_ = 0;
  double clock_set_by_s_ = clock_set_by_s();  // what has been told of it
  std::exception_ptr error_;
  std::atomic<bool> given_up_ = false;  // after `fail_after` failures: no more points
  std::atomic<bool> broken_ = false;    // there is an error: stop at once
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
