#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "sweeps/workers/worker_process.hpp"

namespace pellucid::sweeps {

/// The parent's side of the protocol (worker_protocol.hpp): asks one worker at a time, and turns whatever becomes of it
/// into an answer. A worker that crashed, hung or talked nonsense is gone afterwards; start() makes the next.
class WorkerClient {
 public:
  struct Hooks {
    std::function<void(const std::string& phase, double share)> progress;
    std::function<bool()> idle;                         ///< a few times a second; false stops the wait
    std::function<void(const std::string& line)> note;  ///< what a person should know now
  };
  struct Hello {
    std::string device, driver, clock;
  };
  enum class Outcome { done, failed, stopped };
  struct Answer {
    Outcome outcome = Outcome::failed;
    nlohmann::json row;
    std::vector<double> frame_ms_samples;
    std::string reason;   ///< of a failure, one line
    bool killed = false;  ///< the worker was, from outside, by SIGKILL or SIGTERM: the point may be as good as any
  };

  /// `command` empty: this executable with `worker`. `timeout_s` is a request's budget, and the start's.
  /// `quiet`: see run_worker().
  WorkerClient(std::vector<std::string> command, std::optional<int> device, double timeout_s,
               const std::filesystem::path& quiet = {});

  bool running() const { return process_ != nullptr && process_->alive(); }
  /// Waits for its hello; false when stopped. Throws RuntimeError with the worker's own words when it cannot start.
  bool start(const Hooks&);
  const Hello& hello() const { return hello_; }  ///< of the latest start
  Answer ask(const nlohmann::json& request, const std::string& id, const Hooks&);
  /// Lets an idle worker end by itself.
  void close();

 private:
  Answer crashed(const std::string& why);
  void watch(const Hooks&);
  std::vector<std::string> command_;
  double timeout_s_;
  std::unique_ptr<WorkerProcess> process_;
  bool halted_ = false;  // by a signal, and it has been told
  Hello hello_;
};

}  // namespace pellucid::sweeps
