#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sandbox/arguments.hpp"
#include "sandbox/commands/command_line.hpp"

/// The options that render and reference share: which picture of which scene, where it goes, and what its file says of
/// itself.
namespace pellucid::sandbox {

struct FrameOptions {
  std::string scene, view, size = "720x540";
  std::vector<std::string> settings;  ///< name=value
  std::filesystem::path output;
  std::optional<int> device;
  DisplayOptions display;
  bool json = false;
};
void add_frame_options(cli::App&, FrameOptions&);

}  // namespace pellucid::sandbox
