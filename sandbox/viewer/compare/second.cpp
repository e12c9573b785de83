#include "sandbox/viewer/compare/second.hpp"

#include <utility>
#include <variant>

#include <fmt/format.h>

#include "gl/error.hpp"

namespace pellucid::sandbox {
namespace {

/// The truth depends on no technique: what is left of the state.
ViewState scene_alone(ViewState state) {
  std::erase_if(state.parameters, [](const auto& entry) { return prefix_of(entry.first) != "scene."; });
  state.technique.clear();
  return state;
}

}  // namespace

Second::Second(Workspace& workspace, std::optional<int> device, std::function<void()> wake)
    : workspace_(workspace), device_(device), wake_(std::move(wake)) {}

void Second::choose(Against against, const std::filesystem::path& file) {
  std::shared_ptr<const Image> loaded;
  if (against == Against::file) {
    loaded = std::make_shared<const Image>(read_image(file).image);
    watch_ = std::make_unique<FileWatch>(wake_);
    watch_->add_folder(file.has_parent_path() ? file.parent_path() : std::filesystem::path("."));
  } else {
    watch_.reset();
  }
  against_ = against;
  file_ = file;
  image_ = loaded;
  shown_.reset();
  asked_.reset();
  quality_.clear();
  trouble_.clear();
  workspace_.show_b(against == Against::technique);
  if (against != Against::reference) reference_.reset();
}

void Second::ask_reference() {
  const ViewState wanted = scene_alone(workspace_.state(Side::a));
  if (asked_ == wanted || workspace_.stale(Side::a)) return;  // the frame comes first
  asked_ = wanted;
  image_.reset();
  quality_ = "tracing";
  trouble_.clear();
  if (!reference_) reference_ = std::make_unique<RenderClient>(device_, wake_);
  // A job that still runs is of a state that nobody looks at any more, and may run for minutes.
  reference_->cancel();
  ViewState state = wanted;
  state.technique = workspace_.technique(Side::a);
  reference_->ask({.generation = ++generation_,
                   .state = state,
                   .maps = false,
                   .counts = false,
                   .scene = false,
                   .reference = {{1, 4}, {1, 1}, {4, 1}, {16, 1}, {64, 1}}});
}

void Second::again() {
  if (!trouble_.empty()) asked_.reset();
}

bool Second::poll() {
  if (against_ == Against::technique) {
    if (workspace_.picture(Side::b) == shown_) return false;
    shown_ = workspace_.picture(Side::b);
    image_ = shown_ ? std::shared_ptr<const Image>(shown_, &shown_->image) : nullptr;
    return true;
  }
  if (against_ == Against::file) {
    for (const auto& path : watch_->changed()) {
      if (path.filename() != file_.filename()) continue;
      try {
        image_ = std::make_shared<const Image>(read_image(file_).image);
        trouble_.clear();
        return true;
      } catch (const InputError& e) {
        trouble_ = e.what();  // half written; the next change tells
      }
    }
    return false;
  }
  if (against_ != Against::reference) return false;
  ask_reference();
  bool any = false;
  if (!reference_) return false;
  for (const RenderEvent& event : reference_->take()) {
    if (const auto* picture = std::get_if<PictureEvent>(&event)) {
      if (picture->picture->generation != generation_) continue;
      shown_ = picture->picture;
      image_ = std::shared_ptr<const Image>(shown_, &shown_->image);
      quality_ = shown_->quality + (shown_->converged ? "" : " …");
      any = true;
    } else if (const auto* refused = std::get_if<RefusedEvent>(&event)) {
      if (refused->generation == generation_) trouble_ = refused->reason;
    } else if (const auto* told = std::get_if<ToldEvent>(&event)) {
      workspace_.note(told->words);
    } else if (const auto* ended = std::get_if<EndedEvent>(&event)) {
      if (!ended->reason.empty()) trouble_ = ended->reason;
    }
  }
  return any;
}

std::string Second::words() const {
  if (!trouble_.empty()) return trouble_;
  switch (against_) {
    case Against::nothing:
      return "";
    case Against::technique:
      return workspace_.technique(Side::b);
    case Against::reference:
      return "reference: " + quality_;
    case Against::file:
      return file_.string();
  }
  return "";
}

}  // namespace pellucid::sandbox
