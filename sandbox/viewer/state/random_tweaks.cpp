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

void RandomTweaks::parameter(Workspace& workspace) {
  const std::vector<Workspace::Group> groups = workspace.groups(Side::a);
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
  workspace.set(Side::a, group.prefix + info.name, value);
}

void RandomTweaks::step(Workspace& workspace) {
  if (workspace.busy()) return;
  ++steps_;
  const double what = share();
  try {
    if (what < 0.02) {
      std::vector<std::string> names;
      for (const SceneInfo& info : list_scenes())
        names.push_back(info.name);
      workspace.set_scene(one_of(names));
    } else if (what < 0.08) {
      std::vector<std::string> names;
      for (const TechniqueInfo& info : techniques())
        names.emplace_back(info.name);
      workspace.set_technique(Side::a, one_of(names));
    } else if (what < 0.14 && !workspace.views().empty()) {
      workspace.set_view(one_of(workspace.views()).name);
    } else if (what < 0.25) {
      if (const auto view = workspace.camera())
        workspace.set_camera(
            orbit(*view, static_cast<float>(share() * 80 - 40), static_cast<float>(share() * 40 - 20), 540));
    } else if (what < 0.3) {
      workspace.set_size(32 + static_cast<int>(share() * 160), 24 + static_cast<int>(share() * 120));
    } else {
      parameter(workspace);
    }
  } catch (const InputError&) {
    // A refusal is an answer too.
  }
}

std::string RandomTweaks::disagreement(const Workspace& workspace) {
  const auto& picture = workspace.picture(Side::a);
  if (!picture || workspace.stale(Side::a)) return "";
  const ViewState state = workspace.state(Side::a);
  if (picture->state.scene != state.scene) return "scene";
  if (picture->state.technique != state.technique) return "technique";
  if (!state.view.empty() && picture->state.view != state.view) return "view";
  if (picture->image.width != state.width || picture->image.height != state.height) return "size";
  for (const Workspace::Group& group : workspace.groups(Side::a)) {
    for (const ParameterInfo& info : group.infos) {
      const std::string name = group.prefix + info.name;
      const Value shown = checked(info, sweeps::value_from_json(picture->recipe.at("parameters").at(name)), name);
      const Value panel = workspace.get(Side::a, name);
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
