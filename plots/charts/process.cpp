#include "plots/charts/process.hpp"

#include <array>
#include <cassert>
#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "gl/error.hpp"

extern char** environ;  // POSIX leaves its declaration to the program

namespace pellucid::plots {
namespace {

struct Pipe {
  int ends[2] = {-1, -1};
  Pipe() {
    if (pipe2(ends, O_CLOEXEC) != 0) {
      throw RuntimeError("cannot make a pipe: " + std::generic_category().message(errno));
    }
  }
  ~Pipe() {
    for (const int end : ends) {
      if (end >= 0) close(end);
    }
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void close_write() {
    close(ends[1]);
    ends[1] = -1;
  }
};

struct FileActions {
  posix_spawn_file_actions_t value{};
  FileActions() { posix_spawn_file_actions_init(&value); }
  ~FileActions() { posix_spawn_file_actions_destroy(&value); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;
};

}  // namespace

ProcessResult run_process(const std::vector<std::string>& argv) {
  assert(!argv.empty());
  Pipe output, diagnostics;
  FileActions actions;
  posix_spawn_file_actions_addopen(&actions.value, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions.value, output.ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions.value, diagnostics.ends[1], STDERR_FILENO);

  std::vector<char*> arguments;
  for (const std::string& argument : argv)
    arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);

  ProcessResult result;
  pid_t child = 0;
  const int error = posix_spawnp(&child, arguments[0], &actions.value, nullptr, arguments.data(), environ);
  if (error == ENOENT) {
    result.found = false;
    result.status = 127;
    return result;
  }
  if (error != 0) throw RuntimeError("cannot start " + argv[0] + ": " + std::generic_category().message(error));
  output.close_write();
  diagnostics.close_write();

  // Both streams are drained together, or a child that fills one while we wait for the other would never end.
  std::array<pollfd, 2> watched{{{output.ends[0], POLLIN, 0}, {diagnostics.ends[0], POLLIN, 0}}};
  std::string* const sinks[] = {&result.output, &result.diagnostics};
  int open_streams = 2;
  while (open_streams > 0) {
    if (poll(watched.data(), watched.size(), -1) < 0) {
      if (errno == EINTR) continue;
      break;
    }
    for (std::size_t i = 0; i < watched.size(); ++i) {
      if (watched[i].fd < 0 || watched[i].revents == 0) continue;
      std::array<char, 4096> buffer;
      const ssize_t count = read(watched[i].fd, buffer.data(), buffer.size());
      if (count > 0) {
        sinks[i]->append(buffer.data(), static_cast<std::size_t>(count));
      } else if (count == 0 || errno != EINTR) {
        watched[i].fd = -1;
        --open_streams;
      }
    }
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace pellucid::plots
