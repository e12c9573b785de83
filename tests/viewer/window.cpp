#include "tests/viewer/window.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace pellucid::test {

using nlohmann::json;
using namespace std::chrono_literals;

namespace {

constexpr auto kPatience = 60s;

bool installed(const std::string& program) {
  const Outcome found = run({"sh", "-c", "command -v " + program});
  return found.status == 0;
}

}  // namespace

XServer* XServer::get(std::string& why) {
  static std::string reason;
  static const std::unique_ptr<XServer> server = []() -> std::unique_ptr<XServer> {
    for (const char* program : {"Xvfb", "xdotool", "import"}) {
      if (installed(program)) continue;
      reason = fmt::format("{} is not installed", program);
      return nullptr;
    }
    std::unique_ptr<XServer> started(new XServer);
    int ends[2];
    if (::pipe(ends) != 0) throw std::runtime_error("no pipe to Xvfb");
    started->pid_ = ::fork();
    if (started->pid_ == 0) {
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);
      const int nothing = ::open("/dev/null", O_RDWR);
      ::dup2(nothing, STDOUT_FILENO);
      ::dup2(nothing, STDERR_FILENO);
      const std::string descriptor = std::to_string(ends[1]);
      ::execlp("Xvfb", "Xvfb", "-displayfd", descriptor.c_str(), "-screen", "0", "3200x1800x24", "-nolisten", "tcp",
               "-noreset", nullptr);
      ::_exit(127);
    }
    ::close(ends[1]);
    char digit = 0;
    while (::read(ends[0], &digit, 1) == 1 && digit != '\n')
      started->display_ += digit;
    ::close(ends[0]);
    if (started->display_.empty()) {
      reason = "Xvfb does not start";
      return nullptr;
    }
    started->display_ = ":" + started->display_;
    return started;
  }();
  why = reason;
  return server.get();
}

XServer::~XServer() {
  if (pid_ <= 0) return;
  ::kill(pid_, SIGTERM);
  ::waitpid(pid_, nullptr, 0);
}

ViewerWindow::ViewerWindow(std::vector<std::string> arguments, const TemporaryFolder& folder,
                           std::map<std::string, std::string> env)
    : log_(folder / "window.log"), folder_(folder.path()), env_(std::move(env)) {
  std::string why;
  env_["DISPLAY"] = XServer::get(why)->display();
  env_["LP_NUM_THREADS"] = "2";
  env_.emplace("XDG_CONFIG_HOME", (folder / "config").string());
  std::filesystem::remove(log_);
  arguments.insert(arguments.begin(), {PELLUCID_PROGRAM, "view"});
  arguments.insert(arguments.end(), {"--log", log_.string()});
  for (const auto& [option, value] : {std::pair{"--folder", folder_.string()}, {"--ui-scale", std::string("1")}})
    if (std::find(arguments.begin(), arguments.end(), option) == arguments.end())
      arguments.insert(arguments.end(), {option, value});
  if (const auto scale = std::find(arguments.begin(), arguments.end(), "monitor"); scale != arguments.end())
    arguments.erase(scale - 1, scale + 1);
  process_ = std::make_unique<Background>(arguments, Setting{.folder = folder_, .environment = env_});
  wait("places", [](const json& event) { return event.at("event") == "places"; });
  waited_ = 0;  // the first picture may have come before
  find();
}

void ViewerWindow::find() {
  const Outcome found =
      run({"xdotool", "search", "--pid", std::to_string(pid()), "--name", "Pellucid"}, {.environment = env_});
  // The last line: a window that was just closed may still be listed before its successor.
  const std::string lines = found.out.substr(0, found.out.find_last_not_of('\n') + 1);
  id_ = lines.substr(lines.rfind('\n') + 1);
  if (id_.empty()) throw std::runtime_error("the window is not found: " + found.err);
  xdotool({"windowmove", id_, "0", "0", "windowfocus", "--sync", id_});
}

ViewerWindow::~ViewerWindow() = default;

bool is(const json& event, const char* name) {
  return event.at("event") == name;
}

int ViewerWindow::pid() {
  for (const json& event : events())
    if (event.at("event") == "opened") return event.at("pid");
  throw std::runtime_error("the window has not opened");
}

bool ViewerWindow::running() {
  return process_->running();
}

const std::vector<json>& ViewerWindow::events() {
  std::ifstream file(log_);
  file.seekg(static_cast<std::streamoff>(seen_));
  for (std::string line; std::getline(file, line) && !file.eof();) {
    seen_ += line.size() + 1;
    events_.push_back(json::parse(line));
  }
  return events_;
}

json ViewerWindow::wait(const std::string& what, const std::function<bool(const json&)>& wanted) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  for (;;) {
    const auto& all = events();
    for (; waited_ < all.size(); ++waited_) {
      if (wanted(all[waited_])) return all[waited_++];
    }
    if (std::chrono::steady_clock::now() > deadline || !process_->running()) break;
    std::this_thread::sleep_for(10ms);
  }
  std::string last;
  for (std::size_t i = events_.size() > 8 ? events_.size() - 8 : 0; i < events_.size(); ++i)
    if (events_[i].at("event") != "places") last += "\n" + events_[i].dump().substr(0, 600);
  throw std::runtime_error(
      fmt::format("{} never came{}; the last events:{}", what, running() ? "" : " (the program has ended)", last));
}

json ViewerWindow::wait_picture(const std::function<bool(const json&)>& wanted) {
  return wait("a picture", [&](const json& event) {
    return event.at("event") == "picture" && event.at("side") == "a" && !event.at("stale").get<bool>() &&
           (!wanted || wanted(event.at("recipe")));
  });
}

json ViewerWindow::value(const json& recipe, const std::string& name) {
  return recipe.at("parameters").at(name);
}

std::array<int, 4> ViewerWindow::place(const std::string& id) {
  wait_until("the widget " + id, [&] { return shows(id); });  // a picture is seen before the panel
  const auto& all = events();
  for (auto it = all.rbegin(); it != all.rend(); ++it) {
    if (it->at("event") != "places") continue;
    return it->at("widgets").at(id).get<std::array<int, 4>>();
  }
  throw std::runtime_error("no places are known");
}

bool ViewerWindow::shows(const std::string& id) {
  const auto& all = events();
  for (auto it = all.rbegin(); it != all.rend(); ++it)
    if (it->at("event") == "places") return it->at("widgets").contains(id);
  return false;
}

void ViewerWindow::wait_until(const std::string& what, const std::function<bool()>& reached) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!reached()) {
    if (std::chrono::steady_clock::now() > deadline || !running())
      throw std::runtime_error(fmt::format("{} never came", what));
    std::this_thread::sleep_for(10ms);
  }
}

std::vector<std::string> ViewerWindow::widgets() {
  const auto& all = events();
  std::vector<std::string> out;
  for (auto it = all.rbegin(); it != all.rend() && out.empty(); ++it) {
    if (it->at("event") != "places") continue;
    for (const auto& [id, place] : it->at("widgets").items())
      out.push_back(id);
  }
  return out;
}

void ViewerWindow::wait_status(const std::vector<std::string>& parts) {
  wait("the status", [&](const json& event) {
    return event.at("event") == "status" && std::all_of(parts.begin(), parts.end(), [&](const std::string& part) {
             return event.at("words").get<std::string>().find(part) != std::string::npos;
           });
  });
}

void ViewerWindow::xdotool(const std::vector<std::string>& words) {
  std::vector<std::string> command{"xdotool"};
  command.insert(command.end(), words.begin(), words.end());
  const Outcome done = run(command, {.environment = env_});
  if (done.status != 0) throw std::runtime_error("xdotool: " + done.err);
}

void ViewerWindow::click_at(int x, int y, int button) {
  xdotool({"mousemove", "--window", id_, std::to_string(x), std::to_string(y), "click", std::to_string(button)});
}

void ViewerWindow::click(const std::string& id, double share) {
  const auto [x, y, width, height] = place(id);
  click_at(x + static_cast<int>(share * width), y + height / 2);
}

void ViewerWindow::drag(const std::string& id, double from, double to) {
  const auto [x, y, width, height] = place(id);
  const auto at = [x = x, width = width](double share) { return std::to_string(x + static_cast<int>(share * width)); };
  const std::string row = std::to_string(y + height / 2);
  xdotool({"mousemove", "--window", id_, at(from), row, "mousedown", "1", "mousemove", "--window", id_,
           at((from + to) / 2), row, "mousemove", "--window", id_, at(to), row, "mouseup", "1"});
}

void ViewerWindow::key(const std::string& keys) {
  xdotool({"key", "--window", "0", keys});
}

void ViewerWindow::keys(const std::string& key, int times) {
  xdotool({"key", "--delay", "25", "--repeat", std::to_string(times), "--window", "0", key});
}

void ViewerWindow::type(const std::string& text) {
  xdotool({"type", "--delay", "5", text});
}

void ViewerWindow::tab_to(const std::string& id) {
  for (int i = 0; i < 120; ++i) {
    key("Tab");
    if (wait("a focus", [](const json& event) { return event.at("event") == "focus"; }).at("id") == id) return;
  }
  throw std::runtime_error(fmt::format("Tab does not reach '{}'", id));
}

void ViewerWindow::resize(int width, int height) {
  xdotool({"windowsize", "--sync", id_, std::to_string(width), std::to_string(height)});
}

Image ViewerWindow::screenshot(const std::string& name) {
  const std::string path = (folder_ / name).string();
  const Outcome done = run({"import", "-silent", "-window", id_, path}, {.environment = env_});
  if (done.status != 0) throw std::runtime_error("import: " + done.err);
  if (const char* keep = std::getenv("PELLUCID_KEEP_SCREENSHOTS"))
    std::filesystem::copy_file(path, std::filesystem::path(keep) / name,
                               std::filesystem::copy_options::overwrite_existing);
  return read_image(path).image;
}

void ViewerWindow::close() {
  key("ctrl+q");
  const auto deadline = std::chrono::steady_clock::now() + 10s;
  while (running() && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(20ms);
}

}  // namespace pellucid::test
