#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sandbox/viewer/state/view_state.hpp"

namespace pellucid::sandbox {

struct Bookmark {
  std::string name;
  ViewState state;
};

/// Named set-ups that survive the program: one JSON file, written whole or not at all.
class Bookmarks {
 public:
  /// $XDG_CONFIG_HOME/pellucid/bookmarks.json, or the same below ~/.config.
  static std::filesystem::path standard_file();
  /// A file that cannot be read is told in trouble() and never written over: the next save moves it aside.
  explicit Bookmarks(std::filesystem::path file = standard_file());
  const std::vector<Bookmark>& all() const { return all_; }
  const std::string& trouble() const { return trouble_; }
  /// Adds, or replaces the one of that name, and saves. Throws RuntimeError with the reason; the list is then as
  /// before.
  void put(const std::string& name, const ViewState&);
  void remove(const std::string& name);
  const ViewState* find(const std::string& name) const;

 private:
  void save(const std::vector<Bookmark>&);
  std::filesystem::path file_;
  std::vector<Bookmark> all_;
  std::string trouble_;
};

}  // namespace pellucid::sandbox
