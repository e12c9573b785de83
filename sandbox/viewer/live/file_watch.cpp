#include "sandbox/viewer/live/file_watch.hpp"

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/inotify.h>
#include <unistd.h>

#include "gl/error.hpp"

namespace pellucid::sandbox {

namespace fs = std::filesystem;

FileWatch::FileWatch(std::function<void()> wake)
    : wake_(std::move(wake)), events_(::inotify_init1(IN_CLOEXEC | IN_NONBLOCK)), stop_(::eventfd(0, EFD_CLOEXEC)) {
  if (events_ < 0 || stop_ < 0) throw RuntimeError(fmt::format("files cannot be watched: {}", std::strerror(errno)));
  thread_ = std::thread([this] { listen(); });
}

FileWatch::~FileWatch() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = ::write(stop_, &one, sizeof one);
  thread_.join();
  ::close(events_);
  ::close(stop_);
}

void FileWatch::add_folder(const fs::path& folder) {
  const std::scoped_lock lock(mutex_);
  const int id = ::inotify_add_watch(events_, folder.c_str(), IN_CLOSE_WRITE | IN_MOVED_TO);
  if (id < 0) throw RuntimeError(fmt::format("{} cannot be watched: {}", folder.string(), std::strerror(errno)));
  folders_[id] = folder;
}

void FileWatch::add_tree(const fs::path& folder) {
  add_folder(folder);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    // Neither hidden folders nor builds hold shaders, and they are large.
    if (entry.is_directory() && !entry.is_symlink() && !name.starts_with('.') && name != "build")
      add_tree(entry.path());
  }
}

std::set<fs::path> FileWatch::changed() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(changed_, {});
}

void FileWatch::listen() {
  alignas(inotify_event) std::array<char, 16384> buffer;
  for (;;) {
    std::array<pollfd, 2> files{pollfd{events_, POLLIN, 0}, pollfd{stop_, POLLIN, 0}};
    if (::poll(files.data(), files.size(), -1) < 0 && errno != EINTR) return;
    if (files[1].revents != 0) return;
    const ssize_t bytes = ::read(events_, buffer.data(), buffer.size());
    if (bytes <= 0) continue;
    {
      const std::scoped_lock lock(mutex_);
      for (ssize_t at = 0; at < bytes;) {
        const auto* event = reinterpret_cast<const inotify_event*>(buffer.data() + at);
        if (event->len > 0) changed_.insert(folders_[event->wd] / event->name);
        at += static_cast<ssize_t>(sizeof(inotify_event) + event->len);
      }
    }
    wake_();
  }
}

}  // namespace pellucid::sandbox
