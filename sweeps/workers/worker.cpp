#include "sweeps/workers/worker.hpp"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <exception>
#include <iostream>
#include <mutex>
#include <string>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "gl/context.hpp"
#include "gl/error.hpp"
#include "gl/timer.hpp"
#include "sweeps/measure/measure.hpp"
#include "sweeps/spec/clock.hpp"
#include "sweeps/spec/point_json.hpp"
#include "sweeps/workers/worker_protocol.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;

/// The line to the parent. Standard output itself goes to standard error from now on, so that no library's chatter can
/// get between the lines.
class Line {
 public:
  Line() : file_(::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3)) {
    if (file_ < 0 || ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0) {
      throw RuntimeError(fmt::format("the worker's output: {}", std::strerror(errno)));
    }
  }
  void send(const json& message) {
    const std::string line = to_line(message) + "\n";
    const std::lock_guard lock(mutex_);
    for (std::size_t done = 0; done < line.size();) {
      const ssize_t n = ::write(file_, line.data() + done, line.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) throw RuntimeError(fmt::format("the parent is gone: {}", std::strerror(errno)));
      done += static_cast<std::size_t>(n);
    }
  }

 private:
  int file_;
  std::mutex mutex_;
};

/// Progress from any thread, a few lines a second at most.
class Ticker {
 public:
  explicit Ticker(Line& line) : line_(line) {}
  void operator()(const char* phase, double share) {
    {
      const std::lock_guard lock(mutex_);
      const auto now = std::chrono::steady_clock::now();
      if (phase_ == phase && now - last_ < std::chrono::milliseconds(250)) return;
      phase_ = phase;
      last_ = now;
    }
    line_.send({{"type", "progress"}, {"phase", phase}, {"share", share}});
  }

 private:
  Line& line_;
  std::mutex mutex_;
  std::string phase_;
  std::chrono::steady_clock::time_point last_;
};

json answer(Measurer& measurer, const json& request) {
  const std::string id = request.at("point").at("id");
  try {
    if (request.contains("unix_minus_boot_s")) keep_unix_minus_boot_s(request.at("unix_minus_boot_s"));
    const Point point = point_from_json(request.at("point"));
    const std::string type = request.at("type");
    if (type == "reference") {
      measurer.trace(point, request.at("references").get<std::string>());
      return {{"type", "done"}, {"id", id}, {"row", json::object()}, {"frame_ms_samples", json::array()}};
    }
    const bool whole = type == "measure";
    Measurement result =
        whole ? measurer.measure(point, request.at("references").get<std::string>(), request.value("picture", ""))
              : measurer.time(point);
    return {{"type", "done"},
            {"id", id},
            {"row", std::move(result.row)},
            {"frame_ms_samples", std::move(result.frame_ms_samples)}};
  } catch (const std::exception& e) {
    return {{"type", "failed"}, {"id", id}, {"reason", e.what()}};
  }
}

}  // namespace

int run_worker(std::optional<int> device, const std::filesystem::path& quiet) {
  Line line;
  gl::ContextOptions options;
  options.device = device;
  const gl::Context context(options);
  const gl::PassTimer timer(gl::Detail::frame);
  line.send({{"type", "hello"},
             {"protocol", kProtocol},
             {"device", context.device().renderer},
             {"driver", fmt::format("{} {}", context.device().vendor, context.device().version)},
             {"clock", gl::name(timer.clock())}});

  Ticker ticker(line);
  Measurer measurer([&](const char* phase, double share) { ticker(phase, share); }, quiet);
  for (std::string text; std::getline(std::cin, text);) {
    const json request = json::parse(text, nullptr, false);
    if (!request.is_object() || !request.contains("type") || !request.contains("point") ||
        !request["point"].value("id", json()).is_string()) {
      throw InputError("the worker takes JSON lines from `pellucid sweep run` only");
    }
    line.send(answer(measurer, request));
  }
  return 0;
}

}  // namespace pellucid::sweeps
