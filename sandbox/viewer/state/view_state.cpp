#include "sandbox/viewer/state/view_state.hpp"

#include <cstddef>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "sweeps/spec/point_json.hpp"

namespace pellucid::sandbox {

using nlohmann::json;

json to_recipe(const ViewState& state) {
  json parameters = json::object();
  for (const auto& [name, value] : state.parameters)
    parameters[name] = sweeps::value_to_json(value);
  return {{"scene", state.scene}, {"technique", state.technique}, {"view", state.view},
          {"width", state.width}, {"height", state.height},       {"parameters", parameters}};
}

ViewState from_recipe(const json& recipe, const std::string& source) {
  try {
    ViewState state;
    state.scene = recipe.at("scene");
    state.technique = recipe.at("technique");
    state.view = recipe.at("view");
    state.width = recipe.at("width");
    state.height = recipe.at("height");
    check_image_size(state.width, state.height, source);
    for (const auto& [name, value] : recipe.at("parameters").items()) {
      if (!value.is_primitive() || value.is_null())
        throw InputError(fmt::format("{}: parameter {} is no value: {}", source, name, value.dump()));
      state.parameters[name] = sweeps::value_from_json(value);
    }
    return state;
  } catch (const json::exception& e) {
    throw InputError(fmt::format("{}: not the recipe of a rendered picture: {}", source, e.what()));
  }
}

ViewState state_of_file(const ImageFile& file, const std::string& path) {
  const auto recipe = file.attributes.find("pellucid.recipe");
  const auto command = file.attributes.find("pellucid.command");
  if (recipe == file.attributes.end() || command == file.attributes.end() || command->second != "render") {
    throw InputError(
        fmt::format("{}: only an EXR that pellucid render or the window wrote says how it was made", path));
  }
  const json parsed = json::parse(recipe->second, nullptr, false);
  if (!parsed.is_object()) throw InputError(fmt::format("{}: attribute pellucid.recipe is not a JSON object", path));
  return from_recipe(parsed, path);
}

std::vector<std::string> render_words(const ViewState& state, const std::string& output) {
  std::vector<std::string> words{"pellucid", "render", state.scene, "-t", state.technique};
  if (!state.view.empty()) words.insert(words.end(), {"--view", state.view});
  words.insert(words.end(), {"--size", fmt::format("{}x{}", state.width, state.height)});
  for (const auto& [name, value] : state.parameters)
    words.insert(words.end(), {"-s", fmt::format("{}={}", name, to_text(value))});
  words.insert(words.end(), {"-o", output});
  return words;
}

std::string prefix_of(const std::string& name) {
  const std::size_t dot = name.find('.');
  return dot == std::string::npos ? std::string{} : name.substr(0, dot + 1);
}

}  // namespace pellucid::sandbox
