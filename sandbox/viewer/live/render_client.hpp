#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "sandbox/viewer/live/picture.hpp"
#include "sandbox/viewer/live/shared_pixels.hpp"
#include "sweeps/workers/worker_process.hpp"

namespace pellucid::sandbox {

/// The window's requests to its renderer.
struct RenderRequest {
  std::uint64_t generation = 0;
  ViewState state;
  bool maps = false;    ///< native errors too, as numbers and maps
  bool counts = false;  ///< the renderer's GL objects, for searching leaks
  bool scene = false;   ///< the facts about the scene too, even when the renderer has it already
  /// A technique's frame, or the truth: at each (rays per pixel, divisor of the size) in turn, ever better.
  struct Stage {
    int samples = 1, divide = 1;
  };
  std::vector<Stage> reference;
};

/// One renderer and the thread that talks with it. All calls return at once; what came of them is in take(). A request
/// that has not begun is replaced by the next, so a dragged slider never queues.
class RenderClient {
 public:
  /// `wake` is called from the thread whenever take() has something.
  RenderClient(std::optional<int> device, std::function<void()> wake);
  ~RenderClient();
  RenderClient(const RenderClient&) = delete;
  RenderClient& operator=(const RenderClient&) = delete;

  void ask(RenderRequest);
  void reload_shaders();
  /// Drops what waits and what runs: the process is killed, whatever it is at.
  void cancel();
  /// The next request is drawn by another process.
  void renew();
  std::vector<RenderEvent> take();
  bool busy() const;
  /// The id of the process that draws; 0 when there is none.
  int pid() const { return pid_; }

 private:
  void work();
  void rest();
  void ring() const;
  void serve(const RenderRequest&);
  bool exchange(const std::string& line, std::uint64_t generation);  // false: the process is gone, or cancelled
  bool start(std::uint64_t generation);
  void hear(const std::string& line);
  void end_process(std::uint64_t generation);
  void put(RenderEvent);
  bool interrupted() const { return stop_ || cancelled_; }

  std::optional<int> device_;
  std::function<void()> wake_;
  SharedPixels memory_;
  std::unique_ptr<sweeps::WorkerProcess> process_;  // the thread's own
  bool answered_ = false, refused_ = false;         // the thread's own
  std::uint64_t served_ = 0;                        // the thread's own

  int bell_ = -1;  ///< wakes the thread
  mutable std::mutex mutex_;
  std::optional<RenderRequest> waiting_;
  bool reload_ = false, renew_ = false, running_ = false;
  std::atomic<bool> stop_ = false, cancelled_ = false, overtaken_ = false;
  std::atomic<int> pid_ = 0;
  std::vector<RenderEvent> events_;
  bool last_stage_ = true;
  std::thread thread_;  // last, so that all else is there when it begins
};

}  // namespace pellucid::sandbox
