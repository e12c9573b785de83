#include "sweeps/workers/progress.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "algorithms/scene/files/tell.hpp"

namespace pellucid::sweeps {

std::string duration_text(double seconds) {
  const auto s = static_cast<long long>(std::ceil(std::max(seconds, 0.0)));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {} s", s / 60, s % 60);
  return fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
}

SweepProgress::SweepProgress(std::size_t total, std::size_t done, double expected_s, std::size_t workers, bool quiet)
    : total_(total),
      done_(done),
      workers_(workers),
      quiet_(quiet),
      terminal_(::isatty(STDERR_FILENO) == 1),
      expected_s_(expected_s),
      point_start_(std::chrono::steady_clock::now()) {}

SweepProgress::~SweepProgress() {
  clear();
}

void SweepProgress::begin(std::string what) {
  what_ = std::move(what);
  phase_.clear();
  point_start_ = std::chrono::steady_clock::now();
  last_draw_ = {};
  tick();
}

void SweepProgress::phase(std::string_view name, double share) {
  phase_ = share > 0 ? fmt::format("{} {:.0f} %", name, 100 * share) : std::string(name);
}

void SweepProgress::tick() {
  if (quiet_ || !terminal_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_draw_ < std::chrono::milliseconds(200)) return;
  last_draw_ = now;
  draw();
}

/// How long a point takes, shared among those that are in work at a time.
double SweepProgress::each_s() const {
  const double alone = measured_ > 0 ? measured_s_ / static_cast<double>(measured_) : expected_s_;
  return alone / static_cast<double>(workers_);
}

void SweepProgress::draw() {
  const double in_point = std::chrono::duration<double>(std::chrono::steady_clock::now() - point_start_).count();
  const double each = each_s();
  const double left = each * static_cast<double>(total_ - done_) - std::min(in_point, each);
  constexpr std::size_t kBar = 24;
  const std::size_t filled = total_ > 0 ? kBar * done_ / total_ : kBar;
  std::string line =
      fmt::format("[{}{}] {}/{}", std::string(filled, '#'), std::string(kBar - filled, '.'), done_, total_);
  if (each > 0) line += fmt::format("  {} left", duration_text(left));
  line += "  " + what_;
  if (!phase_.empty()) line += fmt::format(" ({})", phase_);
  struct winsize size {};
  const std::size_t columns = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col : 80U;
  if (line.size() >= columns) line.resize(columns - 1);
  fmt::print(stderr, "\r\x1b[K{}", printable(line));
  std::fflush(stderr);
  drawn_ = true;
}

void SweepProgress::clear() {
  if (!drawn_) return;
  fmt::print(stderr, "\r\x1b[K");
  std::fflush(stderr);
  drawn_ = false;
}

void SweepProgress::finish(std::string_view what, std::string_view outcome, double wall_s) {
  ++done_;
  ++measured_;
  measured_s_ += wall_s;
  if (quiet_ || terminal_) return;
  const double left = each_s() * static_cast<double>(total_ - done_);
  tell("{}/{} {}: {} ({} left)", done_, total_, what, outcome, duration_text(left));
  std::fflush(stderr);
}

void SweepProgress::note(std::string_view line) {
  if (quiet_) return;
  clear();
  tell_line(line);
  std::fflush(stderr);
}

}  // namespace pellucid::sweeps
