#pragma once

#include <optional>

namespace pellucid::sweeps {

/// `pellucid worker`: renders and measures the points that a parent process sends, one JSON object a line, over
/// standard input and output (protocol: README.md), until the input ends. Returns the exit status.
int run_worker(std::optional<int> device);

}  // namespace pellucid::sweeps
