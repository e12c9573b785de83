#include "sweeps/workers/worker_process.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "gl/error.hpp"

namespace pellucid::sweeps {
namespace {

constexpr std::size_t kMaxLineBytes = std::size_t{64} << 20;
constexpr std::size_t kErrorTailBytes = 4096;
constexpr int kTickMs = 100;
/// Between two turns of the wait; more means that this process was stopped.
constexpr std::chrono::seconds kLongestTurn{2};

void close_file(int& file) {
  if (file >= 0) ::close(std::exchange(file, -1));
}

}  // namespace

WorkerProcess::WorkerProcess(const std::vector<std::string>& command) : child_(start_process(command)) {
  ::fcntl(child_.from, F_SETFL, O_NONBLOCK);
  ::fcntl(child_.errors, F_SETFL, O_NONBLOCK);
}

WorkerProcess::~WorkerProcess() {
  end();
  close_file(child_.from);
  close_file(child_.errors);
}

bool WorkerProcess::alive() const {
  siginfo_t info{};
  if (child_.pid < 0 || ::waitid(P_PID, static_cast<id_t>(child_.pid), &info, WEXITED | WNOHANG | WNOWAIT) != 0)
    return false;
  return info.si_pid == 0;
}

bool WorkerProcess::halted() const {
  std::ifstream file(fmt::format("/proc/{}/stat", child_.pid));
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const std::size_t name_end = text.rfind(") ");  // the name may hold anything
  return child_.pid >= 0 && name_end != std::string::npos && text.substr(name_end + 2, 1) == "T";
}

bool WorkerProcess::send(const std::string& line) {
  const std::string text = line + "\n";
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(child_.to, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

bool WorkerProcess::read_into(int& file, std::string& buffer) {
  std::array<char, 65536> chunk;
  for (;;) {
    const ssize_t n = ::read(file, chunk.data(), chunk.size());
    if (n > 0) {
      buffer.append(chunk.data(), static_cast<std::size_t>(n));
      if (buffer.size() > kMaxLineBytes) return true;
      continue;
    }
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno == EAGAIN) return true;
    close_file(file);
    return false;
  }
}

WorkerProcess::Received WorkerProcess::receive(std::chrono::steady_clock::time_point deadline,
                                               const std::function<bool()>& idle) {
  for (auto last = std::chrono::steady_clock::now();;) {
    if (const std::size_t end = input_.find('\n'); end != std::string::npos) {
      Received received{Event::line, input_.substr(0, end)};
      input_.erase(0, end + 1);
      return received;
    }
    if (child_.from < 0 || input_.size() > kMaxLineBytes) return {Event::ended, std::exchange(input_, {})};
    const auto now = std::chrono::steady_clock::now();
    const bool endless = deadline == std::chrono::steady_clock::time_point::max();
    if (now - last > kLongestTurn && !endless) deadline += now - last;
    last = now;
    if (!idle()) return {Event::stopped, {}};
    std::array<pollfd, 2> files{pollfd{child_.from, POLLIN, 0}, pollfd{child_.errors, POLLIN, 0}};
    // After the deadline it still looks once for what is there already.
    const bool late = now >= deadline;
    if (::poll(files.data(), files.size(), late ? 0 : kTickMs) <= 0) {
      if (late) return {Event::timeout, {}};
      continue;  // a tick, or a signal that `idle` will see
    }
    if (files[1].revents != 0) {
      read_into(child_.errors, error_tail_);
      if (error_tail_.size() > kErrorTailBytes) error_tail_.erase(0, error_tail_.size() - kErrorTailBytes);
    }
    if (files[0].revents != 0) read_into(child_.from, input_);
    if (late && child_.from >= 0 && input_.find('\n') == std::string::npos) return {Event::timeout, {}};
  }
}

std::string WorkerProcess::end() {
  if (child_.pid < 0) return "has ended";
  close_file(child_.to);
  int status = 0;
  pid_t ended = ::waitpid(child_.pid, &status, WNOHANG);
  bool killed = false;
  if (ended == 0) {
    // Its pipe may close a moment before it ends by itself.
    const auto patience = std::chrono::steady_clock::now() + std::chrono::milliseconds(child_.from < 0 ? 500 : 0);
    while (ended == 0 && std::chrono::steady_clock::now() < patience) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      ended = ::waitpid(child_.pid, &status, WNOHANG);
    }
  }
  if (ended == 0) {
    killed = true;
    ::kill(child_.pid, SIGKILL);
    while (::waitpid(child_.pid, &status, 0) < 0 && errno == EINTR) {
    }
  }
  child_.pid = -1;
  if (child_.errors >= 0) read_into(child_.errors, error_tail_);
  if (killed) return "was killed";
  if (WIFSIGNALED(status))
    return fmt::format("was killed by signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status)));
  return fmt::format("ended with status {}", WEXITSTATUS(status));
}

void WorkerProcess::close() {
  close_file(child_.to);
  const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  while (receive(patience, [] { return true; }).event == Event::line) {
  }
  end();
}

std::string WorkerProcess::last_words() const {
  std::string_view text = error_tail_;
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r' || text.back() == ' '))
    text.remove_suffix(1);
  const std::size_t start = text.rfind('\n');
  return std::string(start == std::string_view::npos ? text : text.substr(start + 1));
}

}  // namespace pellucid::sweeps
