#include "sandbox/viewer/state/bookmarks.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "algorithms/scene/files/atomic_file.hpp"
#include "gl/error.hpp"

namespace pellucid::sandbox {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {
constexpr int kVersion = 1;
constexpr std::uintmax_t kMaxBytes = 16U << 20;
}  // namespace

fs::path Bookmarks::standard_file() {
  const auto folder = [](const char* variable) -> fs::path {
    const char* value = std::getenv(variable);
    return value != nullptr ? value : "";
  };
  const fs::path config = folder("XDG_CONFIG_HOME");
  return (config.empty() ? folder("HOME") / ".config" : config) / "pellucid" / "bookmarks.json";
}

Bookmarks::Bookmarks(fs::path file) : file_(std::move(file)) {
  std::error_code error;
  if (!fs::exists(file_, error)) return;
  try {
    if (fs::file_size(file_) > kMaxBytes) throw InputError("it is larger than 16 MB");
    std::ifstream in(file_);
    const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (!in) throw InputError("it cannot be read");
    const json all = json::parse(text);
    if (all.at("version") != kVersion) throw InputError("another version of the program wrote it");
    for (const json& entry : all.at("bookmarks"))
      all_.push_back({entry.at("name"), from_recipe(entry.at("recipe"), entry.at("name"))});
  } catch (const std::exception& e) {
    all_.clear();
    trouble_ = fmt::format("bookmarks: {}: {}", file_.string(), e.what());
  }
}

const ViewState* Bookmarks::find(const std::string& name) const {
  const auto it = std::find_if(all_.begin(), all_.end(), [&](const Bookmark& b) { return b.name == name; });
  return it == all_.end() ? nullptr : &it->state;
}

void Bookmarks::put(const std::string& name, const ViewState& state) {
  std::vector<Bookmark> next = all_;
  const auto it = std::find_if(next.begin(), next.end(), [&](const Bookmark& b) { return b.name == name; });
  if (it == next.end()) {
    next.push_back({name, state});
  } else {
    it->state = state;
  }
  save(next);
}

void Bookmarks::remove(const std::string& name) {
  std::vector<Bookmark> next = all_;
  std::erase_if(next, [&](const Bookmark& b) { return b.name == name; });
  save(next);
}

void Bookmarks::save(const std::vector<Bookmark>& next) {
  std::error_code error;
  fs::create_directories(file_.parent_path(), error);
  json list = json::array();
  for (const Bookmark& bookmark : next)
    list.push_back({{"name", bookmark.name}, {"recipe", to_recipe(bookmark.state)}});
  const fs::path part = fmt::format("{}.part_{}", file_.string(), ::getpid());
  write_text_file(part, json{{"version", kVersion}, {"bookmarks", list}}.dump(2) + "\n");
  if (!trouble_.empty() && fs::exists(file_, error)) {
    // A file that could not be read may still be mended by hand.
    fs::path aside = file_;
    for (int number = 1; fs::exists(aside, error); ++number)
      aside = fmt::format("{}.damaged_{}", file_.string(), number);
    fs::rename(file_, aside, error);
    if (error) {
      const std::string why = error.message();
      fs::remove(part, error);
      throw RuntimeError(fmt::format("cannot move {} aside: {}", file_.string(), why));
    }
  }
  fs::rename(part, file_, error);
  if (error) {
    const std::string why = error.message();
    fs::remove(part, error);
    throw RuntimeError(fmt::format("cannot write {}: {}", file_.string(), why));
  }
  trouble_.clear();
  all_ = next;
}

}  // namespace pellucid::sandbox
