#pragma once

#include <filesystem>
#include <optional>

namespace pellucid::sweeps {

/// `pellucid worker`: renders and measures the points that a parent process sends, one JSON object a line, over
/// standard input and output (protocol: README.md), until the input ends. Returns the exit status.
/// `quiet`: the file that workers of several devices share (measure/quiet_lock.hpp).
int run_worker(std::optional<int> device, const std::filesystem::path& quiet = {});

}  // namespace pellucid::sweeps
