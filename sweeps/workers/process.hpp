#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

/// Starting other programs, and this one again: the one place that forks.
namespace pellucid::sweeps {

/// A child and our ends of the pipes to its standard streams.
struct Child {
  pid_t pid = -1;
  int to = -1, from = -1, errors = -1;
};

/// Starts `argv` (looked up in PATH when it has no slash) without a shell. The child lies in a process group of its
/// own, so that Ctrl-C at a terminal reaches the parent alone, and dies with the parent. A program that is missing
/// shows as an end with status 127. Throws RuntimeError when the system refuses.
Child start_process(const std::vector<std::string>& argv);

struct ProcessResult {
  int status = 0;           ///< exit status; 128 + n when signal n ended it
  std::string output;       ///< standard output
  std::string diagnostics;  ///< standard error
};

/// Starts `argv` with an empty standard input and waits for its end.
ProcessResult run_process(const std::vector<std::string>& argv);

}  // namespace pellucid::sweeps
