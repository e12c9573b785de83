#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "sweeps/workers/process.hpp"

namespace pellucid::sweeps {

/// A child process (process.hpp) that reads and writes lines. Destroying it kills it.
class WorkerProcess {
 public:
  explicit WorkerProcess(const std::vector<std::string>& command);
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  /// False when it has ended by itself.
  bool alive() const;
  /// True while a signal such as SIGSTOP keeps it from running.
  bool halted() const;
  /// False when the child no longer reads.
  bool send(const std::string& line);

  enum class Event { line, ended, timeout, stopped };
  struct Received {
    Event event = Event::timeout;
    std::string line;  ///< without the newline; at `ended`, what came without one
  };
  /// Waits for the next whole line until `deadline`, which moves on by the time for which this process itself was
  /// stopped; with one that has passed it takes what is there. `idle` is called a few times a second; when it returns
  /// false the wait is `stopped`.
  Received receive(std::chrono::steady_clock::time_point deadline, const std::function<bool()>& idle);

  /// The file that becomes readable when it has written something or has ended; negative once it is closed.
  int output() const { return child_.from; }

  /// Kills it if it runs, waits, and tells how it ended: "killed by signal 11 (Segmentation fault)", "ended with status
  /// 1".
  std::string end();
  /// Gives it a moment to end by itself after its input has been closed.
  void close();
  /// The last line that it wrote to standard error; empty without one.
  std::string last_words() const;
  pid_t pid() const { return child_.pid; }

 private:
  bool read_into(int& file, std::string& buffer);
  Child child_;
  std::string input_, error_tail_;
};

}  // namespace pellucid::sweeps
