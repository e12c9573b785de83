#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sandbox/viewer/camera/frame_range.hpp"
#include "sandbox/viewer/state/view_state.hpp"
#include "sweeps/workers/worker_process.hpp"

namespace pellucid::sandbox {

/// Numbered frames of a range of times and a way of the camera: `pellucid render --frames` in a process of its own.
class FrameSeries {
 public:
  /// `way`: views that the camera goes through from the first frame to the last; with less than two it stays where
  /// `state` has it. Makes FOLDER/SCENE_TECHNIQUE_001, or the first number that is free, and starts. Throws
  /// InputError or RuntimeError with the reason (folder, full disk).
  FrameSeries(const ViewState& state, const std::vector<std::string>& way, const FrameRange&, double fps,
              const std::filesystem::path& folder, std::optional<int> device);

  /// Looks what has been written; true when anything has changed.
  bool poll();
  void stop() { process_.reset(); }
  bool running() const { return process_ != nullptr; }
  int done() const { return done_; }
  int count() const { return range_.count(); }
  const std::filesystem::path& folder() const { return folder_; }
  /// The same from a shell, as words.
  const std::vector<std::string>& command() const { return command_; }
  /// Why it ended before its last frame; empty while all is well.
  const std::string& trouble() const { return trouble_; }

 private:
  FrameRange range_;
  std::filesystem::path folder_;
  std::string pattern_;
  std::vector<std::string> command_;
  std::unique_ptr<sweeps::WorkerProcess> process_;
  int done_ = 0;
  std::string trouble_;
};

}  // namespace pellucid::sandbox
