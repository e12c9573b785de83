#include "sandbox/viewer/app/journal.hpp"

#include <utility>

#include <fmt/format.h>

#include "gl/error.hpp"
#include "sweeps/workers/worker_protocol.hpp"

namespace pellucid::sandbox {
namespace {

void collect(const nanogui::Widget* widget, float scale, nlohmann::json& out) {
  for (const nanogui::Widget* child : widget->children()) {
    if (!child->visible()) continue;
    if (!child->id().empty()) {
      const auto at = child->absolutePosition();
      out[child->id()] = {static_cast<int>(static_cast<float>(at.x()) * scale),
                          static_cast<int>(static_cast<float>(at.y()) * scale),
                          static_cast<int>(static_cast<float>(child->width()) * scale),
                          static_cast<int>(static_cast<float>(child->height()) * scale)};
    }
    collect(child, scale, out);
  }
}

}  // namespace

Journal::Journal(const std::filesystem::path& path) {
  if (path.empty()) return;
  file_.open(path, std::ios::trunc);
  if (!file_) throw RuntimeError(fmt::format("--log {}: cannot be written", path.string()));
}

void Journal::write(const nlohmann::json& event) {
  if (on()) file_ << sweeps::to_line(event) << std::endl;
}

void Journal::places(const Desk& desk) {
  if (!on()) return;
  nlohmann::json widgets = nlohmann::json::object();
  collect(&desk, desk.pixelRatio(), widgets);
  const nlohmann::json event{{"event", "places"}, {"widgets", widgets}};
  if (std::string line = event.dump(); line != places_) {
    places_ = std::move(line);
    write(event);
  }
}

void Journal::status(const std::string& words) {
  if (!on() || words == status_) return;
  status_ = words;
  write({{"event", "status"}, {"words", words}});
}

void Journal::focus(const Desk& desk) {
  if (!on()) return;
  const nanogui::Widget* widget = desk.focus();
  const std::string id = widget == nullptr || widget == &desk ? "" : widget->id();
  if (id == focus_) return;
  focus_ = id;
  write({{"event", "focus"}, {"id", id}});
}

void Journal::drawn(const nlohmann::json& event) {
  if (std::string line = event.dump(); line != drawn_) {
    drawn_ = std::move(line);
    write(event);
  }
}

}  // namespace pellucid::sandbox
