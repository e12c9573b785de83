#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "algorithms/scene/images/image.hpp"
#include "tests/sandbox/program.hpp"
#include "tests/temporary_folder.hpp"

/// A real window on an X server of its own, driven by xdotool as a hand would.
namespace pellucid::test {

/// Xvfb on a free display; one for all tests of the process.
class XServer {
 public:
  /// Null, with the reason in `why`, where Xvfb, xdotool or import is missing.
  static XServer* get(std::string& why);
  const std::string& display() const { return display_; }  ///< ":7"
  ~XServer();

 private:
  XServer() = default;
  int pid_ = -1;
  std::string display_;
};

/// True of an event of the log that goes by `name`.
bool is(const nlohmann::json& event, const char* name);

/// `pellucid view` with `arguments`, until it is closed or goes out of scope; "--ui-scale monitor" leaves the scale to
/// the monitor, else it is 1.
class ViewerWindow {
 public:
  ViewerWindow(std::vector<std::string> arguments, const TemporaryFolder&, std::map<std::string, std::string> env = {});
  ~ViewerWindow();

  /// The events of its log, all so far.
  const std::vector<nlohmann::json>& events();
  /// Waits until `wanted` is true of an event that came after the last wait; throws with the last events after 60 s.
  nlohmann::json wait(const std::string& what, const std::function<bool(const nlohmann::json&)>& wanted);
  /// The next picture that is of the panel's own state and for which `wanted` holds of its recipe.
  nlohmann::json wait_picture(const std::function<bool(const nlohmann::json& recipe)>& wanted = {});
  /// The value of parameter `name` in the recipe.
  static nlohmann::json value(const nlohmann::json& recipe, const std::string& name);

  /// Where a widget is now: x, y, width, height in the window.
  std::array<int, 4> place(const std::string& id);
  bool shows(const std::string& id);
  /// Waits until `reached` holds, whatever the events are; throws after 60 s.
  void wait_until(const std::string& what, const std::function<bool()>& reached);
  /// The ids of all widgets that are there now.
  std::vector<std::string> widgets();
  /// Waits for a status line that has all of `parts`.
  void wait_status(const std::vector<std::string>& parts);
  /// Takes the newest window of the program for the one that is driven.
  void find();
  void click(const std::string& id, double share = 0.5);
  void drag(const std::string& id, double from, double to);
  void click_at(int x, int y, int button = 1);
  void keys(const std::string& key, int times);  ///< one key again and again
  void key(const std::string& keys);             ///< as xdotool names them: "Tab", "shift+Tab", "ctrl+s"
  void type(const std::string& text);
  /// Presses Tab until the widget has the focus.
  void tab_to(const std::string& id);
  void resize(int width, int height);
  Image screenshot(const std::string& name);
  void xdotool(const std::vector<std::string>& words);
  bool running();
  int pid();
  const std::string& display() const { return env_.at("DISPLAY"); }
  void close();

 private:
  std::filesystem::path log_, folder_;
  std::unique_ptr<Background> process_;
  std::vector<nlohmann::json> events_;
  std::size_t seen_ = 0, waited_ = 0;
  std::string id_;
  std::map<std::string, std::string> env_;
};

}  // namespace pellucid::test
