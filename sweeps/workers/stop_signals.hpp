#pragma once

#include <array>

#include <signal.h>

namespace pellucid::sweeps {

/// While it lives, SIGINT and SIGTERM are noted instead of ending the process, and SIGPIPE is ignored. One at a time.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  bool caught() const;

 private:
  std::array<struct sigaction, 3> before_{};
};

}  // namespace pellucid::sweeps
