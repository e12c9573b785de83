#include "sandbox/viewer/live/shared_pixels.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include "gl/error.hpp"

namespace pellucid::sandbox {
namespace {

[[noreturn]] void fail(const char* what) {
  throw RuntimeError(fmt::format("shared memory for pictures: {}: {}", what, std::strerror(errno)));
}

}  // namespace

SharedPixels::SharedPixels() : file_(::memfd_create("pellucid pictures", MFD_CLOEXEC)) {
  if (file_ < 0) fail("memfd_create");
}

SharedPixels::~SharedPixels() {
  ::close(file_);
}

std::string SharedPixels::path() const {
  return fmt::format("/proc/{}/fd/{}", ::getpid(), file_);
}

void SharedPixels::copy_to(std::span<float> out) const {
  auto* bytes = reinterpret_cast<char*>(out.data());
  for (std::size_t done = 0; done < out.size_bytes();) {
    const ssize_t n = ::pread(file_, bytes + done, out.size_bytes() - done, static_cast<off_t>(done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("read");
    if (n == 0) throw RuntimeError("shared memory for pictures: the renderer wrote less than a picture");
    done += static_cast<std::size_t>(n);
  }
}

void write_shared_pixels(const std::string& path, std::span<const std::span<const float>> floats) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) fail("open");
  for (const std::span<const float> part : floats) {
    const auto* bytes = reinterpret_cast<const char*>(part.data());
    for (std::size_t done = 0; done < part.size_bytes();) {
      const ssize_t n = ::write(file, bytes + done, part.size_bytes() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) {
        const int reason = errno;
        ::close(file);
        errno = reason;
        fail("write");
      }
      done += static_cast<std::size_t>(n);
    }
  }
  ::close(file);
}

}  // namespace pellucid::sandbox
