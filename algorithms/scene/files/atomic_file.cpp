#include "algorithms/scene/files/atomic_file.hpp"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "gl/error.hpp"

namespace pellucid {

namespace fs = std::filesystem;

AtomicFile::AtomicFile(fs::path target) : target_(std::move(target)) {
  if (target_.empty()) fail(ENOENT);
  std::error_code ignored;
  // A rename would replace a symbolic link by a file, so the link is followed first.
  if (fs::is_symlink(target_, ignored)) {
    if (fs::path real = fs::weakly_canonical(target_, ignored); !ignored) target_ = std::move(real);
  }
  struct stat before {};
  const bool exists = ::stat(target_.c_str(), &before) == 0;
  if (exists && S_ISDIR(before.st_mode)) fail(EISDIR);
  in_place_ = exists && !S_ISREG(before.st_mode);
  const int descriptor = open_unnamed_or_temporary();
  if (descriptor < 0) fail(errno);
  // A file that is overwritten keeps its mode, and its owner where that may be given.
  if (exists && !in_place_) {
    if (::fchown(descriptor, before.st_uid, before.st_gid) != 0) errno = 0;
    ::fchmod(descriptor, before.st_mode & 07777U);
  }
  file_ = ::fdopen(descriptor, "wb");
  if (file_ == nullptr) {
    const int error = errno;
    ::close(descriptor);
    remove_temporary();
    fail(error);
  }
}

/// A file without a name is gone whenever the process ends, Ctrl-C included; where the file system has none, a
/// temporary one is written.
int AtomicFile::open_unnamed_or_temporary() {
  if (in_place_) return ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
  const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
  const int unnamed = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
  if (unnamed >= 0) return unnamed;
  temporary_ = temporary_name();
  const int descriptor = ::open(temporary_.c_str(), O_WRONLY | O_CLOEXEC | O_CREAT | O_EXCL, 0666);
  if (descriptor < 0) temporary_.clear();
  return descriptor;
}

/// Short, since the target's own name may be as long as names can be.
fs::path AtomicFile::temporary_name() const {
  static std::atomic<unsigned> counter{0};
  return target_.parent_path() / fmt::format(".pellucid-{}-{}.tmp", ::getpid(), counter++);
}

void AtomicFile::remove_temporary() {
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  temporary_.clear();
}

AtomicFile::~AtomicFile() {
  if (file_ != nullptr) std::fclose(file_);
  remove_temporary();
}

void AtomicFile::fail(int error_number) const {
  throw RuntimeError(fmt::format("cannot write '{}': {}", target_.string(), std::strerror(error_number)));
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail(errno);
}

void AtomicFile::write(std::string_view text) {
  write(std::as_bytes(std::span(text.data(), text.size())));
}

std::uint64_t AtomicFile::position() {
  const off_t at = ::ftello(file_);
  if (at < 0) fail(errno);
  return static_cast<std::uint64_t>(at);
}

void AtomicFile::seek(std::uint64_t to) {
  if (::fseeko(file_, static_cast<off_t>(to), SEEK_SET) != 0) fail(errno);
}

void AtomicFile::commit() {
  if (std::fflush(file_) != 0) fail(errno);
  if (!in_place_ && temporary_.empty()) {
    // linkat() does not replace a file, so the name comes into being beside it.
    const fs::path name = temporary_name();
    const std::string unnamed = fmt::format("/proc/self/fd/{}", ::fileno(file_));
    if (::linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) != 0) fail(errno);
    temporary_ = name;
  }
  if (std::fclose(std::exchange(file_, nullptr)) != 0) fail(errno);
  if (!in_place_ && std::rename(temporary_.c_str(), target_.c_str()) != 0) fail(errno);
  temporary_.clear();
}

void write_text_file(const fs::path& path, std::string_view text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace pellucid
