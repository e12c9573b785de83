#pragma once

#include <array>

#include <signal.h>

namespace pellucid::sweeps {

/// While it lives, SIGINT and SIGTERM are noted instead of ending the process, SIGUSR1 is taken as a warning that the
/// time is nearly up, and SIGPIPE is ignored. One at a time.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  bool caught() const;  ///< stop at once
  bool warned() const;  ///< stop when the point in work is done

 private:
  std::array<struct sigaction, 4> before_{};
};

}  // namespace pellucid::sweeps
