#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "algorithms/scene/images/image.hpp"

namespace pellucid::sandbox {

/// The outcome of a comparison of two pictures.
struct FlipResult {
  std::shared_ptr<const Image> test, reference;
  Image map;  ///< one channel, 0 to 1
  double flip_mean = 0, rmse = 0, psnr = 0;
  std::string trouble;  ///< why there is none
};

/// HDR-FLIP beside the window: of several requests only the last is computed.
class FlipJob {
 public:
  explicit FlipJob(std::function<void()> wake);
  ~FlipJob();
  FlipJob(const FlipJob&) = delete;
  FlipJob& operator=(const FlipJob&) = delete;
  void ask(std::shared_ptr<const Image> test, std::shared_ptr<const Image> reference);
  /// The newest result, once.
  std::optional<FlipResult> take();

 private:
  void work();
  std::function<void()> wake_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<FlipResult> waiting_, done_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace pellucid::sandbox
