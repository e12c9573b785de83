#include "sweeps/workers/stop_signals.hpp"

namespace pellucid::sweeps {
namespace {

volatile sig_atomic_t stop_requested = 0;  // a signal handler reaches nothing else
constexpr std::array<int, 3> kSignals{SIGINT, SIGTERM, SIGPIPE};

void note_stop(int) {
  stop_requested = 1;
}

}  // namespace

StopSignals::StopSignals() {
  stop_requested = 0;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    struct sigaction action {};
    sigemptyset(&action.sa_mask);
    action.sa_handler = kSignals[i] == SIGPIPE ? SIG_IGN : &note_stop;  // NOLINT: SIG_IGN is a C cast
    sigaction(kSignals[i], &action, &before_[i]);
  }
}

StopSignals::~StopSignals() {
  for (std::size_t i = 0; i < kSignals.size(); ++i)
    sigaction(kSignals[i], &before_[i], nullptr);
}

bool StopSignals::caught() const {
  return stop_requested != 0;
}

}  // namespace pellucid::sweeps
