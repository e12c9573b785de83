#include "sandbox/viewer/compare/flip_job.hpp"

#include <exception>
#include <utility>
#include <vector>

#include "gl/error.hpp"
#include "sweeps/metrics/metrics.hpp"

namespace pellucid::sandbox {

FlipJob::FlipJob(std::function<void()> wake) : wake_(std::move(wake)), thread_([this] { work(); }) {}

FlipJob::~FlipJob() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void FlipJob::ask(std::shared_ptr<const Image> test, std::shared_ptr<const Image> reference) {
  {
    const std::scoped_lock lock(mutex_);
    waiting_ = FlipResult{std::move(test), std::move(reference), {}, 0, 0, 0, {}};
  }
  changed_.notify_all();
}

std::optional<FlipResult> FlipJob::take() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(done_, std::nullopt);
}

void FlipJob::work() {
  for (;;) {
    FlipResult result;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return stop_ || waiting_; });
      if (stop_) return;
      result = *std::exchange(waiting_, std::nullopt);
    }
    try {
      sweeps::ComparisonOptions options;
      options.metrics = sweeps::MetricSet(std::vector<std::string>{"flip", "rmse", "psnr"});
      options.keep_map = true;
      sweeps::ComparisonResult found =
          sweeps::Comparison(*result.reference, nullptr, std::move(options)).compare(*result.test);
      result.map = std::move(found.flip_map);
      result.flip_mean = found.at("flip_mean");
      result.rmse = found.at("rmse");
      result.psnr = found.at("psnr");
    } catch (const std::exception& e) {
      result.trouble = e.what();
    }
    {
      const std::scoped_lock lock(mutex_);
      done_ = std::move(result);
    }
    wake_();
  }
}

}  // namespace pellucid::sandbox
