#include "tests/sandbox/program.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

namespace pellucid::test {
namespace {

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error(what + ": " + std::strerror(errno));
}

/// Runs `command` in a child with its own process group; the descriptors become its standard output and error.
pid_t start(const std::vector<std::string>& command, const Setting& setting, int out, int err) {
  std::vector<char*> arguments;
  for (const std::string& word : command)
    arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const int nothing = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  const pid_t pid = ::fork();
  if (pid < 0) fail("fork");
  if (pid > 0) {
    ::close(nothing);
    ::setpgid(pid, pid);
    return pid;
  }
  ::setpgid(0, 0);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(out < 0 ? nothing : out, STDOUT_FILENO);
  ::dup2(err < 0 ? nothing : err, STDERR_FILENO);
  if (!setting.folder.empty() && ::chdir(setting.folder.c_str()) != 0) ::_exit(126);
  for (const auto& [name, value] : setting.environment)
    ::setenv(name.c_str(), value.c_str(), 1);
  ::execvp(arguments.front(), arguments.data());
  ::_exit(127);
}

struct Pipe {
  std::array<int, 2> ends{};
  Pipe() {
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail("pipe");
  }
  ~Pipe() {
    close_write();
    ::close(ends[0]);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int read_end() const { return ends[0]; }
  int write_end() const { return ends[1]; }
  void close_write() {
    if (ends[1] >= 0) ::close(ends[1]);
    ends[1] = -1;
  }
};

/// Appends what is there; false at the end.
bool drain(int descriptor, std::string& text) {
  std::array<char, 65536> buffer;
  const ssize_t n = ::read(descriptor, buffer.data(), buffer.size());
  if (n > 0) text.append(buffer.data(), static_cast<std::size_t>(n));
  return n > 0 || (n < 0 && errno == EINTR);
}

}  // namespace

Outcome run(const std::vector<std::string>& command, const Setting& setting) {
  const auto begin = std::chrono::steady_clock::now();
  Pipe out, err;
  const pid_t pid = start(command, setting, out.write_end(), err.write_end());
  out.close_write();
  err.close_write();

  Outcome outcome;
  std::array<pollfd, 2> watched{{{out.read_end(), POLLIN, 0}, {err.read_end(), POLLIN, 0}}};
  const std::array<std::string*, 2> texts{&outcome.out, &outcome.err};
  while (watched[0].fd >= 0 || watched[1].fd >= 0) {
    if (::poll(watched.data(), watched.size(), -1) < 0 && errno != EINTR) fail("poll");
    for (std::size_t i = 0; i < watched.size(); ++i) {
      if (watched[i].revents != 0 && !drain(watched[i].fd, *texts[i])) watched[i].fd = -1;
      watched[i].revents = 0;
    }
  }
  int state = 0;
  while (::waitpid(pid, &state, 0) < 0) {
    if (errno != EINTR) fail("waitpid");
  }
  if (WIFEXITED(state)) outcome.status = WEXITSTATUS(state);
  if (WIFSIGNALED(state)) outcome.signal = WTERMSIG(state);
  outcome.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return outcome;
}

Outcome pellucid(std::vector<std::string> arguments, const Setting& setting) {
  arguments.insert(arguments.begin(), PELLUCID_PROGRAM);
  return run(arguments, setting);
}

Background::Background(const std::vector<std::string>& command, const Setting& setting)
    : pid_(start(command, setting, -1, -1)) {}

Background::~Background() {
  stop(SIGKILL);
}

void Background::stop(int signal) {
  if (pid_ <= 0) return;  // it has ended; -1 would name every process
  ::kill(-pid_, signal);
  while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
}

bool Background::running() {
  if (pid_ <= 0) return false;
  if (::waitpid(pid_, nullptr, WNOHANG) == 0) return true;
  pid_ = -1;
  return false;
}

testing::AssertionResult refused(const Outcome& outcome, int status, const std::vector<std::string>& parts) {
  auto failure = [&](const std::string& why) {
    return testing::AssertionFailure() << why << "\nstatus " << outcome.status << ", signal " << outcome.signal
                                       << "\nstdout: " << outcome.out << "\nstderr: " << outcome.err;
  };
  if (outcome.status != status) return failure("expected status " + std::to_string(status));
  std::vector<std::string> errors;
  std::size_t lines = 0;
  std::istringstream text(outcome.err);
  for (std::string line; std::getline(text, line); ++lines) {
    if (line.starts_with("error: ")) errors.push_back(line);
  }
  if (errors.size() != 1) return failure("expected one error line, got " + std::to_string(errors.size()));
  for (const std::string& part : parts) {
    if (errors.front().find(part) == std::string::npos) return failure("expected the error to name '" + part + "'");
  }
  if (status == 2 && lines != 1) return failure("expected one line, got " + std::to_string(lines));
  if (status == 2 && !outcome.out.empty()) return failure("expected nothing on standard output");
  return testing::AssertionSuccess();
}

testing::AssertionResult succeeded(const Outcome& outcome) {
  if (outcome.status == 0) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "status " << outcome.status << ", signal " << outcome.signal
                                     << "\nstdout: " << outcome.out << "\nstderr: " << outcome.err;
}

std::filesystem::path write_small_scene(const TemporaryFolder& folder) {
  return write_file(folder / "small.scene.toml", R"(title = "A pole in a box of fog"
ambient = [0.3, 0.3, 0.35]

[materials.grey]
albedo = [0.5, 0.5, 0.5]

[meshes.floor]
shape = "plane"
size = [6, 6]

[meshes.pole]
shape = "cylinder"
radius = 0.2
height = 1.4
segments = 16

[instances.floor]
mesh = "floor"
material = "grey"

[instances.pole]
mesh = "pole"
material = "grey"

[lights.sun]
kind = "directional"
azimuth_deg = 30
elevation_deg = 50
intensity = 2

[environment]
zenith = [0.2, 0.3, 0.5]
horizon = [0.6, 0.6, 0.6]
ground = [0.1, 0.1, 0.1]

[volume]
kind = "fog"
voxels = 16
center = [0, 0.75, 0]
size = [3, 1.5, 3]
extinction = 1.5
albedo = [0.9, 0.9, 0.9]
seed = 3

[views.front]
eye = [0, 1.2, 4]
target = [0, 0.6, 0]

[views.side]
eye = [4, 1.2, 0]
target = [0, 0.6, 0]

[parameters.density]
doc = "of the fog, relative to the scene's own"
mode = "scale"
drives = ["volume.extinction"]
range = [0, 10]
default = 1
)");
}

}  // namespace pellucid::test
