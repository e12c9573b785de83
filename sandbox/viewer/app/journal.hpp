#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <nlohmann/json.hpp>

#include "sandbox/viewer/panel/desk.hpp"

namespace pellucid::sandbox {

/// The window's contents as JSON lines for tests and reports of faults (`--log FILE`): the places of widgets in window
/// pixels, pictures with their state, the status line, the focus. Each is written when it has changed.
class Journal {
 public:
  /// Empty: writes nothing. Throws RuntimeError when the file cannot be made.
  explicit Journal(const std::filesystem::path&);
  bool on() const { return file_.is_open(); }
  void write(const nlohmann::json&);
  void places(const Desk&);
  void status(const std::string&);
  void focus(const Desk&);
  void drawn(const nlohmann::json&);

 private:
  std::ofstream file_;
  std::string places_, status_, focus_, drawn_;
};

}  // namespace pellucid::sandbox
