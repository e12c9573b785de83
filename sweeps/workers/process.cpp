#include "sweeps/workers/process.hpp"

#include <array>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "gl/error.hpp"

namespace pellucid::sweeps {
namespace {

/// Closed when it goes out of scope.
struct Pipe {
  std::array<int, 2> ends{-1, -1};
  Pipe() {
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw RuntimeError(fmt::format("no pipe: {}", std::strerror(errno)));
  }
  ~Pipe() {
    for (const int end : ends) {
      if (end >= 0) ::close(end);
    }
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int take(std::size_t end) { return std::exchange(ends[end], -1); }
};

/// Runs between fork and exec: async-signal-safe calls only.
[[noreturn]] void become(char* const* argv, int in, int out, int err, pid_t parent) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(125);  // it died before the line above
  for (const int s : {SIGINT, SIGTERM, SIGPIPE})
    ::signal(s, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  if (::dup2(in, STDIN_FILENO) >= 0 && ::dup2(out, STDOUT_FILENO) >= 0 && ::dup2(err, STDERR_FILENO) >= 0) {
    ::execvp(argv[0], argv);
  }
  const char* words = std::strerror(errno);
  const ssize_t ignored = ::write(STDERR_FILENO, words, std::strlen(words));
  static_cast<void>(ignored);
  ::_exit(127);
}

}  // namespace

Child start_process(const std::vector<std::string>& command) {
  assert(!command.empty());
  std::vector<char*> argv;
  for (const std::string& word : command)
    argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  Pipe in, out, err;
  const pid_t parent = ::getpid();
  Child child;
  child.pid = ::fork();
  if (child.pid == 0) become(argv.data(), in.ends[0], out.ends[1], err.ends[1], parent);
  if (child.pid < 0) throw RuntimeError(fmt::format("cannot start {}: {}", command[0], std::strerror(errno)));
  child.to = in.take(1);
  child.from = out.take(0);
  child.errors = err.take(0);
  return child;
}

ProcessResult run_process(const std::vector<std::string>& argv) {
  const Child child = start_process(argv);
  ::close(child.to);
  ProcessResult result;
  // Both streams are drained together, or a child that fills one while we wait for the other would never end.
  std::array<pollfd, 2> watched{pollfd{child.from, POLLIN, 0}, pollfd{child.errors, POLLIN, 0}};
  const std::array<std::string*, 2> sinks{&result.output, &result.diagnostics};
  int open_streams = 2;
  while (open_streams > 0) {
    if (::poll(watched.data(), watched.size(), -1) < 0) {
      if (errno == EINTR) continue;
      break;
    }
    for (std::size_t i = 0; i < watched.size(); ++i) {
      if (watched[i].fd < 0 || watched[i].revents == 0) continue;
      std::array<char, 65536> buffer;
      const ssize_t count = ::read(watched[i].fd, buffer.data(), buffer.size());
      if (count > 0) {
        sinks[i]->append(buffer.data(), static_cast<std::size_t>(count));
      } else if (count == 0 || errno != EINTR) {
        watched[i].fd = -1;
        --open_streams;
      }
    }
  }
  ::close(child.from);
  ::close(child.errors);
  int status = 0;
  while (::waitpid(child.pid, &status, 0) < 0 && errno == EINTR) {
  }
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace pellucid::sweeps
