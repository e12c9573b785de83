#pragma once

#include <string>
#include <vector>

namespace pellucid::plots {

struct ProcessResult {
  int status = 0;           ///< exit status; 128 + n when signal n ended it
  std::string output;       ///< standard output
  std::string diagnostics;  ///< standard error
  bool found = true;        ///< false when there is no such program
};

/// Runs a program (looked up in PATH) without a shell and with an empty standard input, and waits for it. Throws
/// RuntimeError when the system refuses; a program that is missing or fails is for the caller to judge.
ProcessResult run_process(const std::vector<std::string>& argv);

}  // namespace pellucid::plots
