#include "sandbox/viewer/state/workspace.hpp"

#include <array>
#include <chrono>
#include <span>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "algorithms/render_session.hpp"
#include "algorithms/scene/view_text.hpp"
#include "gl/error.hpp"

namespace pellucid::sandbox {
namespace {

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

const ParameterInfo* find(std::span<const ParameterInfo> infos, std::string_view name) {
  for (const ParameterInfo& info : infos)
    if (info.name == name) return &info;
  return nullptr;
}

bool takes(const ParameterInfo& info, const Value& value) {
  try {
    checked(info, value, "");
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

Workspace::Workspace(const ViewState& initial, std::optional<int> device, std::function<void()> wake)
    : device_(device), wake_(std::move(wake)) {
  client_[0] = std::make_unique<RenderClient>(device_, wake_);
  set_state(initial);
}

// ---- parameters ----

std::vector<Workspace::Group> Workspace::groups(Side side) const {
  std::vector<Group> out;
  const auto own = find_technique(technique(side)).table().infos();
  out.push_back({technique(side), "", {own.begin(), own.end()}});
  if (!loaded_.parameters.empty()) out.push_back({"scene " + scene_, "scene.", loaded_.parameters});
  for (const CommonSettings& common : common_settings()) {
    const auto infos = common.table->infos();
    out.push_back({std::string(common.prefix), std::string(common.prefix) + ".", {infos.begin(), infos.end()}});
  }
  return out;
}

const ParameterInfo* Workspace::shared_info(const std::string& name) const {
  const std::string prefix = prefix_of(name), bare = name.substr(prefix.size());
  if (prefix == "scene.") return find(loaded_.parameters, bare);
  for (const CommonSettings& common : common_settings())
    if (prefix == std::string(common.prefix) + ".") return common.table->find(bare);
  return nullptr;
}

const ParameterInfo* Workspace::info(Side side, const std::string& name) const {
  return prefix_of(name).empty() ? find_technique(technique(side)).table().find(name) : shared_info(name);
}

std::map<std::string, Value>& Workspace::values_of(Side side, const std::string& name) {
  return prefix_of(name).empty() ? own_[index(side)][technique(side)] : shared_;
}

const std::map<std::string, Value>& Workspace::values_of(Side side, const std::string& name) const {
  static const std::map<std::string, Value> none;
  if (!prefix_of(name).empty()) return shared_;
  const auto it = own_[index(side)].find(technique(side));
  return it == own_[index(side)].end() ? none : it->second;
}

Value Workspace::get(Side side, const std::string& name) const {
  const auto& values = values_of(side, name);
  if (const auto it = values.find(name); it != values.end()) return it->second;
  const ParameterInfo* known = info(side, name);
  return known != nullptr ? known->default_value : Value{};
}

void Workspace::set(Side side, const std::string& name, const Value& value) {
  if (take(side, name, value)) ask();
}

void Workspace::set(Side side, const std::vector<std::pair<std::string, Value>>& values) {
  bool changed = false;
  for (const auto& [name, value] : values)
    changed = take(side, name, value) || changed;
  if (changed) ask();
}

bool Workspace::take(Side side, const std::string& name, const Value& value) {
  const ParameterInfo* known = info(side, name);
  if (known == nullptr) {
    for (const Group& group : groups(side))
      if (group.prefix == prefix_of(name))
        throw unknown_parameter(name.substr(group.prefix.size()), group.title, group.infos);
    throw InputError(fmt::format("unknown parameter '{}'", name));
  }
  const Value good = checked(*known, value, prefix_of(name).empty() ? technique(side) : prefix_of(name));
  if (to_text(good) == to_text(get(side, name))) return false;
  auto& values = values_of(side, name);
  if (to_text(good) == to_text(known->default_value)) {
    values.erase(name);
  } else {
    values[name] = good;
  }
  return true;
}

// ---- what is shown ----

ViewState Workspace::state(Side side) const {
  ViewState state{scene_, technique(side), view_, width_, height_, shared_};
  const auto it = own_[index(side)].find(technique(side));
  if (it != own_[index(side)].end()) state.parameters.insert(it->second.begin(), it->second.end());
  return state;
}

void Workspace::set_state(const ViewState& state) {
  find_technique(state.technique);
  if (state.scene != scene_) loaded_ = {};
  scene_ = state.scene;
  technique_[0] = state.technique;
  if (technique_[1].empty()) technique_[1] = state.technique;
  view_ = state.view;
  width_ = state.width;
  height_ = state.height;
  shared_.clear();
  carried_.clear();
  auto& own = own_[0][state.technique];
  own.clear();
  for (const auto& [name, value] : state.parameters) {
    if (prefix_of(name) == "scene." && loaded_.scene != scene_) {
      carried_[name] = value;  // judged when the scene is known
      continue;
    }
    const ParameterInfo* known = info(Side::a, name);
    if (known != nullptr && to_text(known->default_value) == to_text(value)) continue;
    (prefix_of(name).empty() ? own : shared_)[name] =
        known != nullptr ? checked(*known, value, state.technique) : value;
  }
  ++structure_;
  ask();
}

void Workspace::set_scene(const std::string& scene) {
  if (scene == scene_) return;
  for (auto it = shared_.begin(); it != shared_.end();) {
    if (prefix_of(it->first) == "scene.") {
      carried_.insert(*it);
      it = shared_.erase(it);
    } else {
      ++it;
    }
  }
  scene_ = scene;
  view_.clear();
  loaded_ = {};
  ++structure_;
  ask();
}

void Workspace::set_technique(Side side, const std::string& technique) {
  if (technique == technique_[index(side)]) return;
  const auto former = own_[index(side)][technique_[index(side)]];
  const auto infos = find_technique(technique).table().infos();
  technique_[index(side)] = technique;
  // The values that a technique of this name had before come back; else those of the former one under the same names.
  if (!own_[index(side)].contains(technique)) {
    auto& own = own_[index(side)][technique];
    for (const auto& [name, value] : former) {
      const ParameterInfo* known = find(infos, name);
      if (known != nullptr && takes(*known, value)) own[name] = value;
    }
  }
  ++structure_;
  ask();
}

void Workspace::set_view(const std::string& name) {
  if (name == view_) return;
  view_ = name;
  ask();
}

void Workspace::set_camera(const View& view) {
  set_view(to_view_text(view));
}

void Workspace::set_size(int width, int height) {
  if (width == width_ && height == height_) return;
  width_ = width;
  height_ = height;
  ask();
}

std::optional<View> Workspace::camera() const {
  if (loaded_.views.empty()) return std::nullopt;
  Scene stand_in;
  stand_in.name = scene_;
  stand_in.views = loaded_.views;
  try {
    return view_of(stand_in, view_);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

// ---- renderers ----

void Workspace::show_b(bool on) {
  if (on == b_on_) return;
  b_on_ = on;
  if (!on) {
    client_[1].reset();
    picture_[1].reset();
    trouble_[1].clear();
    return;
  }
  client_[1] = std::make_unique<RenderClient>(device_, wake_);
  ask();
}

void Workspace::want_maps(bool on) {
  if (on == maps_) return;
  maps_ = on;
  if (on) ask();
}

void Workspace::ask() {
  ++generation_;
  for (const Side side : {Side::a, Side::b}) {
    if (side == Side::b && !b_on_) continue;
    asked_[index(side)] = generation_;
    client_[index(side)]->ask({.generation = generation_,
                               .state = state(side),
                               .maps = maps_,
                               .counts = counts_,
                               .scene = side == Side::a && loaded_.scene != scene_,
                               .reference = {}});
  }
}

void Workspace::renew() {
  for (const auto& client : client_)
    if (client) client->renew();
  ask();
}

void Workspace::cancel() {
  for (const auto& client : client_)
    if (client) client->cancel();
  phase_.clear();
  trouble_[0] = "cancelled";
  if (const auto& shown = picture_[0]) {
    const ViewState back = shown->state;
    set_state(back);
    trouble_[0] = "cancelled; this is the state before";
  }
}

void Workspace::reload_shaders() {
  for (const auto& client : client_)
    if (client) client->reload_shaders();
}

bool Workspace::busy() const {
  return (client_[0] && client_[0]->busy()) || (client_[1] && client_[1]->busy());
}

bool Workspace::stale(Side side) const {
  const auto& shown = picture_[index(side)];
  return !shown || shown->generation != asked_[index(side)];
}

std::string Workspace::phase() const {
  if (!busy() || phase_.empty()) return "";
  const double passed = now_s() - phase_began_s_;
  if (passed < 0.5) return phase_;
  const std::string share = phase_share_ < 0 ? "" : fmt::format(" {:.0f} %", 100 * phase_share_);
  return fmt::format("{}{} … {:.0f} s (Esc cancels)", phase_, share, passed);
}

std::vector<int> Workspace::pids() const {
  std::vector<int> out;
  for (const auto& client : client_)
    if (client && client->pid() != 0) out.push_back(client->pid());
  return out;
}

std::string Workspace::trouble() const {
  if (trouble_[0].empty() && !trouble_[1].empty()) return "B: " + trouble_[1];
  return trouble_[0];
}

bool Workspace::poll() {
  bool any = false;
  for (const Side side : {Side::a, Side::b}) {
    if (!client_[index(side)]) continue;
    for (const RenderEvent& event : client_[index(side)]->take()) {
      hear(side, event);
      any = true;
    }
  }
  return any;
}

void Workspace::scene_loaded(const LoadedScene& loaded) {
  if (loaded.scene != scene_) return;  // switched on meanwhile
  loaded_ = loaded;
  ++structure_;
  bool carried = false;
  std::string refused;
  for (const auto& [name, value] : std::exchange(carried_, {})) {
    const ParameterInfo* known = shared_info(name);
    if (known == nullptr || !takes(*known, value)) continue;
    if (to_text(known->default_value) == to_text(value)) continue;
    shared_[name] = checked(*known, value, "scene");
    carried = true;
  }
  if (carried) ask();
}

void Workspace::note(const std::string& words) {
  if (told_.insert(words).second) notes_.push_back(words);
}

void Workspace::hear(Side side, const RenderEvent& event) {
  if (const auto* phase = std::get_if<PhaseEvent>(&event)) {
    if (phase_ != phase->words) phase_began_s_ = now_s();
    phase_ = phase->words;
    phase_share_ = phase->share;
  } else if (const auto* scene = std::get_if<SceneEvent>(&event)) {
    if (side == Side::a) scene_loaded(scene->loaded);
  } else if (const auto* picture = std::get_if<PictureEvent>(&event)) {
    picture_[index(side)] = picture->picture;
    ++pictures_seen_;
    if (!stale(side)) trouble_[index(side)].clear();
    phase_.clear();
  } else if (const auto* refused = std::get_if<RefusedEvent>(&event)) {
    if (refused->generation == asked_[index(side)]) trouble_[index(side)] = refused->reason;
    if (refused->failed) {
      ++failures_;
      last_failure_ = refused->reason;
    }
    phase_.clear();
  } else if (const auto* told = std::get_if<ToldEvent>(&event)) {
    note(told->words);
  } else if (const auto* shaders = std::get_if<ShadersEvent>(&event)) {
    shader_error_ = shaders->error;
    ask();
  } else if (const auto* ended = std::get_if<EndedEvent>(&event)) {
    phase_.clear();
    if (ended->reason.empty()) return;
    ++failures_;
    last_failure_ = ended->reason;
    trouble_[index(side)] = fmt::format("{}; F5 starts another with the same state", ended->reason);
  }
}

}  // namespace pellucid::sandbox
