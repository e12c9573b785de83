#include "sweeps/workers/worker_client.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "gl/error.hpp"
#include "sweeps/workers/progress.hpp"
#include "sweeps/workers/worker_protocol.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;
using Event = WorkerProcess::Event;

constexpr std::chrono::milliseconds kWatchEvery{500};

std::chrono::steady_clock::time_point after(double seconds) {
  return std::chrono::steady_clock::now() +
         std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(seconds));
}

/// The start of a line that is not what it should be, fit for a message.
std::string excerpt(const std::string& line) {
  std::string text = line.substr(0, 60);
  for (char& c : text)
    c = c < ' ' || c > '~' ? '?' : c;
  return line.size() > 60 ? text + "…" : text;
}

std::string type_of(const json& message) {
  if (!message.is_object()) return "";
  const auto type = message.find("type");
  return type != message.end() && type->is_string() ? type->get<std::string>() : "";
}

template <class T>
T field(const json& message, const char* name, T otherwise) {
  try {
    return message.value(name, otherwise);
  } catch (const json::exception&) {
    return otherwise;
  }
}

}  // namespace

WorkerClient::WorkerClient(std::vector<std::string> command, std::optional<int> device, double timeout_s,
                           const std::filesystem::path& quiet)
    : command_(std::move(command)), timeout_s_(timeout_s) {
  if (command_.empty()) {
    command_ = {"/proc/self/exe", "worker"};
    if (device) command_.insert(command_.end(), {"--device", std::to_string(*device)});
    if (!quiet.empty()) command_.insert(command_.end(), {"--quiet-lock", quiet.string()});
  }
}

bool WorkerClient::start(const Hooks& hooks) {
  process_ = std::make_unique<WorkerProcess>(command_);
  const WorkerProcess::Received received = process_->receive(after(timeout_s_), hooks.idle);
  if (received.event == Event::stopped) {
    process_.reset();
    return false;
  }
  const json hello = received.event == Event::line ? json::parse(received.line, nullptr, false) : json();
  if (type_of(hello) == "hello" && field(hello, "protocol", 0) == kProtocol) {
    hello_ = {field(hello, "device", std::string()), field(hello, "driver", std::string()),
              field(hello, "clock", std::string())};
    return true;
  }
  std::string why;
  if (received.event == Event::timeout) why = fmt::format("said nothing for {}", duration_text(timeout_s_));
  if (received.event == Event::line) why = fmt::format("began with '{}'", excerpt(received.line));
  const std::string end = process_->end();
  if (why.empty()) why = end;
  std::string words = process_->last_words();
  if (words.starts_with("error: ")) words.erase(0, 7);
  process_.reset();
  // Status 2 is what `main` gives to bad input, such as a device that does not exist.
  if (received.event == Event::ended && end == "ended with status 2" && !words.empty()) throw InputError(words);
  throw RuntimeError(fmt::format("no render worker: it {}{}{}", why, words.empty() ? "" : ": ", words));
}

WorkerClient::Answer WorkerClient::crashed(const std::string& why) {
  const std::string end = process_->end();
  const std::string words = process_->last_words();
  process_.reset();
  Answer answer;
  answer.killed =
      why.empty() && (end.starts_with("was killed by signal 9 ") || end.starts_with("was killed by signal 15 "));
  answer.reason = why.empty() ? fmt::format("the worker {}", end) : why;
  if (!words.empty()) answer.reason += fmt::format("; its last words: {}", words);
  return answer;
}

/// Tells once that the worker has been stopped, and once that it goes on.
void WorkerClient::watch(const Hooks& hooks) {
  if (process_->halted() == halted_) return;
  halted_ = !halted_;
  hooks.note(halted_
                 ? fmt::format("note: the worker has been stopped by a signal and has {} for its point; to let it go "
                               "on: kill -CONT {}",
                               duration_text(timeout_s_), process_->pid())
                 : "note: the worker goes on");
}

WorkerClient::Answer WorkerClient::ask(const json& request, const std::string& id, const Hooks& hooks) {
  const auto deadline = after(timeout_s_);
  halted_ = false;
  auto watched = std::chrono::steady_clock::now();
  const auto idle = [&] {
    if (const auto now = std::chrono::steady_clock::now(); now - watched > kWatchEvery) {
      watched = now;
      watch(hooks);
    }
    return hooks.idle();
  };
  if (!process_->send(to_line(request))) return crashed("");
  for (;;) {
    const WorkerProcess::Received received = process_->receive(deadline, idle);
    switch (received.event) {
      case Event::stopped: {
        process_.reset();
        Answer answer;
        answer.outcome = Outcome::stopped;
        return answer;
      }
      case Event::timeout:
        return crashed(fmt::format("the worker {}took longer than timeout_s = {}",
                                   process_->halted() ? "was stopped by a signal and " : "", timeout_s_));
      case Event::ended:
        return crashed(
            received.line.empty() ? "" : fmt::format("the worker's answer breaks off: '{}'", excerpt(received.line)));
      case Event::line:
        break;
    }
    json message = json::parse(received.line, nullptr, false);
    const std::string type = type_of(message);
    if (type == "progress") {
      hooks.progress(field(message, "phase", std::string()), field(message, "share", 0.0));
      continue;
    }
    Answer answer;
    if (type == "failed" && field(message, "id", std::string()) == id) {
      answer.reason = field(message, "reason", std::string("the worker gave no reason"));
      return answer;
    }
    const bool samples_good = message.is_object() && message.contains("frame_ms_samples") &&
                              message["frame_ms_samples"].is_array() &&
                              std::all_of(message["frame_ms_samples"].begin(), message["frame_ms_samples"].end(),
                                          [](const json& sample) { return sample.is_number(); });
    if (type == "done" && field(message, "id", std::string()) == id && samples_good && message.contains("row") &&
        message["row"].is_object()) {
      answer.outcome = Outcome::done;
      answer.row = std::move(message["row"]);
      answer.frame_ms_samples = message["frame_ms_samples"].get<std::vector<double>>();
      return answer;
    }
    return crashed(fmt::format("the worker sent what is no answer: '{}'", excerpt(received.line)));
  }
}

void WorkerClient::close() {
  if (process_) process_->close();
  process_.reset();
}

}  // namespace pellucid::sweeps
