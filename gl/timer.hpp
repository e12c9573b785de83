#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pellucid::gl {

/// Which clock a time was read from. `gpu_query`: timestamp queries in a ring, never stalling. `finish`: glFinish and
/// GL_TIMESTAMP around the work, the only one that tells the truth on CPU rasterisers, which bin commands.
enum class Clock { gpu_query, finish };
const char* name(Clock);  ///< "gpu_query", "finish"

/// The choice of what is timed: the frame as a whole, or each pass too. Under `finish` the passes cannot overlap when
/// timed one by one, so frames are timed with `frame` and the split is measured apart.
enum class Detail { off, frame, passes };

struct FrameTime {
  double frame_ms = 0;
  std::vector<std::pair<std::string, double>> pass_ms;  ///< in order of first use; a pass that runs twice is summed
};

/// Times frames and their named passes. `off` costs nothing, so that techniques always take a timer.
class PassTimer {
 public:
  explicit PassTimer(Detail detail = Detail::off);
  PassTimer(Detail detail, Clock clock);  ///< forces a clock, for tests
  ~PassTimer();
  PassTimer(PassTimer&&) noexcept;
  PassTimer& operator=(PassTimer&&) noexcept;

  Clock clock() const { return clock_; }

  /// Ends the pass when it leaves scope. Passes do not nest.
  class Pass {
   public:
    explicit Pass(PassTimer* timer) : timer_(timer) {}
    ~Pass();
    Pass(const Pass&) = delete;
    Pass& operator=(const Pass&) = delete;

   private:
    PassTimer* timer_;
  };

  /// Frames do not nest; one that an exception left open is dropped. The latest 256 unread frames are kept.
  void begin_frame();
  [[nodiscard]] Pass pass(std::string_view name);
  void end_frame();
  /// The oldest finished frame whose times are known; nothing while the GPU is still at it. `wait` blocks for it.
  std::optional<FrameTime> poll();
  std::optional<FrameTime> wait();

 private:
  void end_pass();
  struct State;
  State* state_ = nullptr;
  Detail detail_ = Detail::off;
  Clock clock_ = Clock::finish;
};

}  // namespace pellucid::gl
