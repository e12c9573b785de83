#pragma once

#include <filesystem>

namespace pellucid::plots {

/// An empty file in the system's folder for temporary files, removed at the end: for programs and libraries that only
/// read or write by name. Throws RuntimeError when it cannot be made.
class ScratchFile {
 public:
  ScratchFile();
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace pellucid::plots
