#include "sandbox/viewer/state/random_tweaks.hpp"

#include <cmath>
#include <cstddef>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "gl/error.hpp"
#include "sandbox/viewer/camera/orbit.hpp"
#include "sweeps/spec/point_json.hpp"

namespace pellucid::sandbox {

template <class T>
const T& RandomTweaks::one_of(const std::vector<T>& all) {
  return all[std::uniform_int_distribution<std::size_t>(0, all.size() - 1)(random_)];
}

std::string RandomTweaks::comparison() {
  const double what = share();
  if (what >= 0.04) return "";
  if (what >= 0.02) return kNothing;
  const auto& all = techniques();
  return std::string(all[std::uniform_int_distribution<std::size_t>(0, all.size() - 1)(random_)].name);
}

void RandomTweaks::parameter(Workspace& workspace, Side side) {
  const std::vector<Workspace::Group> groups = workspace.groups(side);
  const Workspace::Group& group = one_of(groups);
  if (group.infos.empty()) return;
  const ParameterInfo& info = one_of(group.infos);
  Value value;
  switch (info.type) {
    case ValueType::boolean:
      value = share() < 0.5;
      break;
    case ValueType::choice:
      value = one_of(info.choices);
      break;
    case ValueType::integer:
    case ValueType::real: {
      // Near the lower end for the most part: the upper end of many ranges is a frame of seconds.
      const double along = std::pow(share(), 4.0);
      const double number = info.min + along * (info.max - info.min);
      if (info.type == ValueType::integer) {
        value = static_cast<std::int64_t>(std::llround(number));
      } else {
        value = number;
      }
    }
  }
  parameters_.insert(group.prefix.empty()       ? workspace.technique(side) + "." + info.name
                     : group.prefix == "scene." ? workspace.scene() + "." + info.name
                                                : group.prefix + info.name);
  workspace.set(side, group.prefix + info.name, value);
}

void RandomTweaks::step(Workspace& workspace) {
  if (workspace.busy()) return;
  ++steps_;
  techniques_.insert(workspace.technique(Side::a));
  scenes_.insert(workspace.scene());
  const double what = share();
  const std::vector<TechniqueInfo> all(techniques().begin(), techniques().end());
  try {
    if (what < 0.04) {
      // Together with a technique, since few draw all scenes.
      std::vector<std::string> names;
      for (const SceneInfo& info : list_scenes())
        names.push_back(info.name);
      workspace.set_scene(one_of(names));
      workspace.set_technique(Side::a, std::string(one_of(all).name));
    } else if (what < 0.08) {
      workspace.set_technique(Side::a, std::string(one_of(all).name));
    } else if (what < 0.14 && !workspace.views().empty()) {
      workspace.set_view(one_of(workspace.views()).name);
    } else if (what < 0.25) {
      if (const auto view = workspace.camera())
        workspace.set_camera(
            orbit(*view, static_cast<float>(share() * 80 - 40), static_cast<float>(share() * 40 - 20), 540));
    } else if (what < 0.3) {
      workspace.set_size(32 + static_cast<int>(share() * 160), 24 + static_cast<int>(share() * 120));
    } else {
      parameter(workspace, workspace.shows_b() && share() < 0.3 ? Side::b : Side::a);
    }
  } catch (const InputError&) {
    // A refusal is an answer too.
  }
}

std::string RandomTweaks::disagreement(const Workspace& workspace) {
  for (const Side side : {Side::a, Side::b})
    if (std::string words = disagreement(workspace, side); !words.empty()) return words;
  return "";
}

std::string RandomTweaks::disagreement(const Workspace& workspace, Side side) {
  const auto& picture = workspace.picture(side);
  if (!picture || workspace.stale(side)) return "";
  const ViewState state = workspace.state(side);
  if (picture->state.scene != state.scene) return "scene";
  if (picture->state.technique != state.technique) return "technique";
  if (!state.view.empty() && picture->state.view != state.view) return "view";
  if (picture->image.width != state.width || picture->image.height != state.height) return "size";
  for (const Workspace::Group& group : workspace.groups(side)) {
    for (const ParameterInfo& info : group.infos) {
      const std::string name = group.prefix + info.name;
      const Value shown = checked(info, sweeps::value_from_json(picture->recipe.at("parameters").at(name)), name);
      const Value panel = workspace.get(side, name);
      // Parameters are floats in the technique and doubles in the panel.
      const auto* a = std::get_if<double>(&shown);
      const auto* b = std::get_if<double>(&panel);
      const bool same =
          a != nullptr && b != nullptr ? static_cast<float>(*a) == static_cast<float>(*b) : shown == panel;
      if (!same) return fmt::format("{}: the picture has {}, the panel {}", name, to_text(shown), to_text(panel));
    }
  }
  return "";
}

}  // namespace pellucid::sandbox
