#include "sweeps/measure/quiet_lock.hpp"

#include <cerrno>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "gl/error.hpp"

namespace pellucid::sweeps {

QuietLock::QuietLock(const std::filesystem::path& file) {
  if (file.empty()) return;
  file_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (file_ < 0) throw RuntimeError(fmt::format("'{}' cannot be made: {}", file.string(), std::strerror(errno)));
}

QuietLock::~QuietLock() {
  if (file_ >= 0) ::close(file_);
}

void QuietLock::take(int kind) {
  while (file_ >= 0 && ::flock(file_, kind) != 0 && errno == EINTR) {
  }
}

void QuietLock::wait_to_work() {
  take(LOCK_EX);
}
void QuietLock::wait_to_time() {
  take(LOCK_SH);
}
void QuietLock::release() {
  take(LOCK_UN);
}

QuietFile::QuietFile(bool needed) {
  if (needed) path_ = std::filesystem::temp_directory_path() / fmt::format("pellucid-quiet-{}", ::getpid());
}

QuietFile::~QuietFile() {
  std::error_code error;
  if (!path_.empty()) std::filesystem::remove(path_, error);
}

}  // namespace pellucid::sweeps
