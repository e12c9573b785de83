#include "sandbox/viewer/live/frame_series.hpp"

#include <chrono>
#include <cstddef>
#include <system_error>

#include <fmt/format.h>

#include "gl/error.hpp"
#include "sandbox/viewer/app/save.hpp"

namespace pellucid::sandbox {

FrameSeries::FrameSeries(const ViewState& state, const std::vector<std::string>& way, const FrameRange& range,
                         double fps, const std::filesystem::path& folder, std::optional<int> device)
    : range_(range),
      folder_(free_name(folder, std::filesystem::path(state.scene).stem().string() + "_" + state.technique, "")) {
  ViewState first = state;
  if (way.size() > 1) first.view = way.front();
  pattern_ = (folder_ / "frame.%04d.exr").string();
  command_ = render_words(first, pattern_);
  for (std::size_t i = 1; i < way.size(); ++i)
    command_.insert(command_.end(), {"--through", way[i]});
  command_.insert(command_.end(),
                  {"--frames", fmt::format("{}:{}", range.first, range.last), "--fps", fmt::format("{}", fps)});
  if (device) command_.insert(command_.end(), {"--device", fmt::format("{}", *device)});
  std::error_code failed;
  std::filesystem::create_directories(folder_, failed);
  if (failed) throw RuntimeError(fmt::format("{}: {}", folder_.string(), failed.message()));
  std::vector<std::string> words = command_;
  words.front() = "/proc/self/exe";
  process_ = std::make_unique<sweeps::WorkerProcess>(words);
}

bool FrameSeries::poll() {
  if (!process_) return false;
  // Its pipes are emptied, or it would wait for us.
  while (process_->receive(std::chrono::steady_clock::now(), [] { return true; }).event ==
         sweeps::WorkerProcess::Event::line) {
  }
  const int before = done_;
  const bool ended = !process_->alive();
  // A frame that is there is whole: files appear under their names when they are complete.
  while (done_ < count() && std::filesystem::exists(numbered(pattern_, range_.first + done_)))
    ++done_;
  if (ended) {
    const std::string how = process_->end();
    if (done_ < count()) trouble_ = fmt::format("rendering {} {}: {}", folder_.string(), how, process_->last_words());
    process_.reset();
  }
  return ended || done_ != before;
}

}  // namespace pellucid::sandbox
