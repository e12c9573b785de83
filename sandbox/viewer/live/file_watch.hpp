#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

namespace pellucid::sandbox {

/// Tells which files have been written, by the kernel's word (inotify) and at once; it costs nothing while none is.
/// Folders are watched, not files, so that editors which write a new file and rename it are noticed too.
class FileWatch {
 public:
  /// `wake` is called from a thread of its own when changed() has something.
  explicit FileWatch(std::function<void()> wake);
  ~FileWatch();
  FileWatch(const FileWatch&) = delete;
  FileWatch& operator=(const FileWatch&) = delete;

  /// A folder with all folders in it. Throws RuntimeError when the system refuses.
  void add_tree(const std::filesystem::path& folder);
  void add_folder(const std::filesystem::path& folder);
  /// Files written since the last call.
  std::set<std::filesystem::path> changed();

 private:
  void listen();
  std::function<void()> wake_;
  int events_ = -1, stop_ = -1;
  std::mutex mutex_;
  std::map<int, std::filesystem::path> folders_;
  std::set<std::filesystem::path> changed_;
  std::thread thread_;
};

}  // namespace pellucid::sandbox
