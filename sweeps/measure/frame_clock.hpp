#pragma once

#include <deque>
#include <functional>
#include <vector>

#include "gl/timer.hpp"

namespace pellucid::sweeps {

/// Draws frames one behind the other without waiting for the GPU, and puts their times where each belongs. Belongs to
/// the GL context in which it was made.
class FrameClock {
 public:
  using Draw = std::function<void(gl::PassTimer&)>;

  explicit FrameClock(gl::Detail detail = gl::Detail::frame) : timer_(detail) {}

  gl::Clock clock() const { return timer_.clock(); }
  /// `into` [ms]: nullptr for a frame whose time does not count. Throws RuntimeError when the clock gives no usable
  /// time.
  void draw(const Draw& subject, std::vector<double>* into);
  /// Draws frames of `subject` until the time of one is known, and returns the oldest.
  gl::FrameTime next(const Draw& subject);
  /// Waits for what is still being drawn, so that it does not reach into what is timed next.
  void drain();

 private:
  void take(const gl::FrameTime&);

  gl::PassTimer timer_;
  std::deque<std::vector<double>*> due_;
};

}  // namespace pellucid::sweeps
