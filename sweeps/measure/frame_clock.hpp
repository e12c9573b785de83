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

  gl::Clock clock() const { return timer_.clock(); }
  /// `into` [ms]: nullptr for a frame whose time does not count. Throws RuntimeError when the clock gives no usable
  /// time.
  void draw(const Draw& subject, std::vector<double>* into);
  void drain();

 private:
  void take(const gl::FrameTime&);

  gl::PassTimer timer_{gl::Detail::frame};
  std::deque<std::vector<double>*> due_;
};

}  // namespace pellucid::sweeps
