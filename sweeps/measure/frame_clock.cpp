#include "sweeps/measure/frame_clock.hpp"

#include <cassert>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "gl/error.hpp"

namespace pellucid::sweeps {
namespace {

constexpr std::size_t kFramesInFlight = 8;

}  // namespace

void FrameClock::draw(const Draw& subject, std::vector<double>* into) {
  if (due_.size() >= kFramesInFlight) take(*timer_.wait());
  subject(timer_);
  due_.push_back(into);
  while (auto time = timer_.poll())
    take(*time);
}

gl::FrameTime FrameClock::next(const Draw& subject) {
  for (;;) {
    if (!due_.empty()) {
      if (auto time = due_.size() >= kFramesInFlight ? timer_.wait() : timer_.poll()) {
        take(*time);
        return std::move(*time);
      }
    }
    subject(timer_);
    due_.push_back(nullptr);
  }
}

void FrameClock::drain() {
  while (!due_.empty())
    take(*timer_.wait());
}

void FrameClock::take(const gl::FrameTime& time) {
  assert(!due_.empty());
  if (due_.front() != nullptr) {
    if (!std::isfinite(time.frame_ms) || time.frame_ms <= 0) {
      throw RuntimeError(fmt::format("bench: the clock gave {} ms for a frame", time.frame_ms));
    }
    due_.front()->push_back(time.frame_ms);
  }
  due_.pop_front();
}

}  // namespace pellucid::sweeps
