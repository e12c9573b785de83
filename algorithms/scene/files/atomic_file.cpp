#include "algorithms/scene/files/atomic_file.hpp"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
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
  const fs::file_status status = fs::status(target_, ignored);
  if (fs::is_directory(status)) fail(EISDIR);
  const bool in_place = fs::exists(status) && !fs::is_regular_file(status);
  static std::atomic<unsigned> counter{0};
  written_ = target_;
  if (!in_place) written_ += fmt::format(".{}-{}.tmp", ::getpid(), counter++);
  const int flags = O_WRONLY | O_CLOEXEC | (in_place ? 0 : O_CREAT | O_EXCL);
  const int descriptor = ::open(written_.c_str(), flags, 0666);
  if (descriptor < 0) {
    const int error = errno;
    written_.clear();
    fail(error);
  }
  file_ = ::fdopen(descriptor, "wb");
  if (file_ == nullptr) {
    const int error = errno;
    ::close(descriptor);
    if (!in_place) ::unlink(written_.c_str());
    fail(error);
  }
}

AtomicFile::~AtomicFile() {
  if (file_ != nullptr) std::fclose(file_);
  if (!written_.empty() && written_ != target_) ::unlink(written_.c_str());
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
  if (std::fclose(std::exchange(file_, nullptr)) != 0) fail(errno);
  if (written_ != target_) {
    if (std::rename(written_.c_str(), target_.c_str()) != 0) fail(errno);
  }
  written_.clear();
}

void write_text_file(const fs::path& path, std::string_view text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace pellucid
