#pragma once

#include <filesystem>

namespace pellucid::sweeps {

/// Keeps the workers of one machine out of each other's times: any number may time at once, each on a GPU of its own,
/// but none while another prepares or compares, which takes the CPU's cores. Without a file it does nothing.
class QuietLock {
 public:
  /// Throws RuntimeError when the file cannot be made.
  explicit QuietLock(const std::filesystem::path& file = {});
  ~QuietLock();
  QuietLock(const QuietLock&) = delete;
  QuietLock& operator=(const QuietLock&) = delete;

  void wait_to_work();  ///< alone
  void wait_to_time();  ///< among others that time
  void release();

 private:
  void take(int kind);
  int file_ = -1;
};

/// The parent's side: the name of such a file, unless it is not needed, and its end.
class QuietFile {
 public:
  explicit QuietFile(bool needed);
  ~QuietFile();
  QuietFile(const QuietFile&) = delete;
  QuietFile& operator=(const QuietFile&) = delete;
  const std::filesystem::path& path() const { return path_; }  ///< empty: not needed

 private:
  std::filesystem::path path_;
};

}  // namespace pellucid::sweeps
