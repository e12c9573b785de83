#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace pellucid::sandbox {

struct PaperOptions {
  std::string what;              ///< a paper's name, or "all"
  std::filesystem::path folder;  ///< gets index.html and a folder for each paper; made when missing
  std::optional<int> device;
  bool preview = false;
  bool json = false;
};

/// Measures what the folder does not hold yet, draws the pictures that it lacks, then writes every table, figure and
/// the report anew. This process makes no GL context. Returns the exit status: kFailed when a point failed. Throws
/// InputError with the nearest name for an unknown paper.
int reproduce_papers(const PaperOptions&);

}  // namespace pellucid::sandbox
