#include "sweeps/workers/stop_signals.hpp"

#include <cstddef>

namespace pellucid::sweeps {
namespace {

volatile sig_atomic_t stop_requested = 0;  // a signal handler reaches nothing else
volatile sig_atomic_t warning_given = 0;
constexpr std::array<int, 4> kSignals{SIGINT, SIGTERM, SIGUSR1, SIGPIPE};

void note_stop(int) {
  stop_requested = 1;
}
void note_warning(int) {
  warning_given = 1;
}

}  // namespace

StopSignals::StopSignals() {
  stop_requested = 0;
  warning_given = 0;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    struct sigaction action {};
    sigemptyset(&action.sa_mask);
    action.sa_handler = kSignals[i] == SIGUSR1 ? &note_warning : &note_stop;
    if (kSignals[i] == SIGPIPE) action.sa_handler = SIG_IGN;  // NOLINT: a C cast
    sigaction(kSignals[i], &action, &before_[i]);
  }
}

StopSignals::~StopSignals() {
  for (std::size_t i = 0; i < kSignals.size(); ++i)
    sigaction(kSignals[i], &before_[i], nullptr);
}

bool StopSignals::warned() const {
  return warning_given != 0;
}

bool StopSignals::caught() const {
  return stop_requested != 0;
}

}  // namespace pellucid::sweeps
