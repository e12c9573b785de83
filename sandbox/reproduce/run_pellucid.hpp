#pragma once

#include <string>
#include <vector>

namespace pellucid::sandbox {

/// Runs this same program with `arguments` and waits for it; returns what it printed. Work that needs GL runs so in a
/// process of its own. Throws as the child would have: InputError for its status 2, RuntimeError for the rest, with its
/// own words.
std::string run_pellucid(const std::vector<std::string>& arguments);

}  // namespace pellucid::sandbox
