#include "sweeps/store/store_lock.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include "gl/error.hpp"
#include "sweeps/spec/provenance.hpp"

namespace pellucid::sweeps {
namespace {

/// Numbers of linux/magic.h and of the file systems' own sources.
constexpr std::array<std::uint32_t, 14> kNetworkFileSystems{
    0x6969,      // NFS
    0x0BD00BD0,  // Lustre
    0x47504653,  // GPFS
    0x517B,      // SMB
    0xFF534D42,  // CIFS
    0xFE534D42,  // SMB 2
    0x00C36400,  // Ceph
    0x19830326,  // BeeGFS
    0x65735546,  // FUSE: sshfs, GlusterFS
    0x01021997,  // 9p
    0x5346414F,  // AFS
    0x73757245,  // Coda
    0x7461636F,  // OCFS2
    0x01161970   // GFS2
};

/// When a process began, in clock ticks since the machine's start: tells it from a later one of the same number.
std::string start_of(pid_t pid) {
  std::ifstream file(fmt::format("/proc/{}/stat", pid));
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const std::size_t name_end = text.rfind(')');  // the name may hold anything
  if (name_end == std::string::npos) return "";
  std::istringstream fields(text.substr(name_end + 1));
  std::string field;
  for (int i = 3; i <= 22; ++i)
    fields >> field;
  return field;
}

struct Owner {
  std::string host, start;
  pid_t pid = 0;
};

std::optional<Owner> read_owner(int file) {
  std::array<char, 512> text{};
  const ssize_t n = ::pread(file, text.data(), text.size() - 1, 0);
  if (n <= 0) return std::nullopt;
  std::istringstream fields(std::string(text.data(), static_cast<std::size_t>(n)));
  Owner owner;
  if (!(fields >> owner.host >> owner.pid >> owner.start)) return std::nullopt;
  return owner;
}

bool lives(const Owner& owner) {
  return ::kill(owner.pid, 0) == 0 && start_of(owner.pid) == owner.start;
}

}  // namespace

bool on_network_file_system(const std::filesystem::path& path) {
  if (const char* told = std::getenv("PELLUCID_NETWORK_STORES"); told != nullptr && *told != '\0') {
    if (std::strcmp(told, "1") == 0) return true;
    if (std::strcmp(told, "0") == 0) return false;
    throw InputError(fmt::format("PELLUCID_NETWORK_STORES = '{}' is neither 0 nor 1", told));
  }
  struct statfs facts {};
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  if (::statfs(path.c_str(), &facts) != 0 && ::statfs(folder.c_str(), &facts) != 0) return false;
  const auto type = static_cast<std::uint32_t>(facts.f_type);
  return std::find(kNetworkFileSystems.begin(), kNetworkFileSystems.end(), type) != kNetworkFileSystems.end();
}

WriteLock::WriteLock(const std::filesystem::path& store) : store_(store.string()), path_(store_ + "-lock") {
  while (!acquire())
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

/// False: try again, since the file has changed hands meanwhile.
bool WriteLock::acquire() {
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file_ < 0) {
    const int reason = errno;
    if (reason == EACCES || reason == EROFS) {
      const std::string folder = std::filesystem::path(store_).parent_path().string();
      throw RuntimeError(fmt::format("store '{}' cannot be written: its folder '{}' is read-only ({})", store_,
                                     folder.empty() ? "." : folder, std::strerror(reason)));
    }
    if (reason != EEXIST)
      throw RuntimeError(fmt::format("store '{}' cannot be written: {}", store_, std::strerror(reason)));
    const int other = ::open(path_.c_str(), O_RDWR | O_CLOEXEC);
    if (other < 0 && errno == ENOENT) return false;
    if (other < 0) {
      throw RuntimeError(fmt::format("store '{}' cannot be written: {}", store_, std::strerror(errno)));
    }
    try {
      const bool again = take_over(other);
      ::close(other);
      return again;
    } catch (...) {
      ::close(other);
      throw;
    }
  }
  ::flock(file_, LOCK_EX | LOCK_NB);  // where it works it goes with the process, however that ends
  const std::string owner = fmt::format("{} {} {}\n", host_name(), ::getpid(), start_of(::getpid()));
  struct stat facts {};
  if (::write(file_, owner.data(), owner.size()) != static_cast<ssize_t>(owner.size()) || ::fstat(file_, &facts) != 0) {
    const int reason = errno;
    ::unlink(path_.c_str());
    ::close(file_);
    throw RuntimeError(fmt::format("store '{}' cannot be written: {}", store_, std::strerror(reason)));
  }
  inode_ = facts.st_ino;
  return true;
}

/// Removes a dead owner's file; always false, so that all who wait race for the new one. Throws when the owner lives.
bool WriteLock::take_over(int file) {
  if (::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    throw RuntimeError(fmt::format("store '{}' is being written by another sweep", store_));
  }
  struct stat judged {};
  if (::fstat(file, &judged) != 0) return false;
  const std::optional<Owner> owner = read_owner(file);
  // Without a name its owner may be about to sign. The file's age may be wrong, since clocks are set; then ten seconds
  // of waiting for it tell.
  if (!owner && std::time(nullptr) - judged.st_mtime < 10) {
    const auto now = std::chrono::steady_clock::now();
    if (unsigned_inode_ != judged.st_ino) {
      unsigned_inode_ = judged.st_ino;
      unsigned_since_ = now;
    }
    if (now - unsigned_since_ < std::chrono::seconds(10)) return false;
  }
  if (owner && owner->host != host_name()) {
    throw RuntimeError(fmt::format(
        "store '{}' is being written by process {} of {}, or was when that ended; if no sweep runs there, remove {}",
        store_, owner->pid, owner->host, path_));
  }
  if (owner && lives(*owner)) {
    throw RuntimeError(fmt::format("store '{}' is being written by another sweep (process {})", store_, owner->pid));
  }
  // Renaming takes one file only, so of several who found the owner dead one succeeds; who takes the wrong one, a new
  // owner's, gives it back.
  const std::string aside = fmt::format("{}.{}.{}", path_, host_name(), ::getpid());
  if (::rename(path_.c_str(), aside.c_str()) != 0) {
    if (errno == ENOENT) return false;
    throw RuntimeError(fmt::format("store '{}' cannot be written: {}", store_, std::strerror(errno)));
  }
  struct stat taken {};
  if (::stat(aside.c_str(), &taken) == 0 && taken.st_ino != judged.st_ino) ::link(aside.c_str(), path_.c_str());
  ::unlink(aside.c_str());
  return false;
}

void WriteLock::check() const {
  struct stat facts {};
  if (::stat(path_.c_str(), &facts) == 0 && facts.st_ino == inode_) return;
  throw RuntimeError(
      fmt::format("store '{}' is no longer this sweep's: {} has been removed or replaced; the rows stored so far stay",
                  store_, path_));
}

WriteLock::~WriteLock() {
  if (file_ < 0) return;
  struct stat facts {};
  if (::stat(path_.c_str(), &facts) == 0 && facts.st_ino == inode_) ::unlink(path_.c_str());
  ::close(file_);
}

}  // namespace pellucid::sweeps
