#pragma once

#include <string>
#include <vector>

namespace pellucid::sweeps {

/// The commit that this binary was built from (40 hex digits, or "unknown" outside a git tree), and whether the tree
/// had changes or new files then. Written by the build (commit.cmake).
extern const char* const kCommit;
extern const bool kDirty;

/// "2007-10-29T12:34:56Z"
std::string utc_text(double unix_s);

/// This machine's name on its network.
std::string host_name();

/// The command line of this process.
std::vector<std::string> process_argv();

/// `text` as one word of a POSIX shell, quoted only where it must be.
std::string shell_word(const std::string& text);
std::string shell_line(const std::vector<std::string>& argv);

}  // namespace pellucid::sweeps
