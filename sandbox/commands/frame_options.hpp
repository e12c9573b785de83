#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "algorithms/scene/images/image.hpp"
#include "sandbox/arguments.hpp"
#include "sandbox/commands/command_line.hpp"

/// What render and reference share: which picture of which scene, where it goes, and what its file says of itself.
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

/// Where a file comes from: version, commit, time, command line.
nlohmann::ordered_json file_provenance();
/// What a file must know to be made again (`pellucid reproduce FILE.exr`), and where it comes from.
Attributes file_attributes(const char* command, const nlohmann::ordered_json& recipe,
                           const nlohmann::ordered_json& origin);

}  // namespace pellucid::sandbox
