#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "algorithms/scene/scene.hpp"
#include "algorithms/scene/toml/scene_source.hpp"
#include "gl/resources.hpp"

namespace pellucid {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t kMaxSceneBytes = std::uintmax_t{1} << 24;

std::vector<std::string> scene_resources() {
  std::vector<std::string> names = list_resources("algorithms/", ".toml");
  std::erase_if(names, [](const std::string& name) { return fs::path(name).parent_path().filename() != "scenes"; });
  return names;
}

/// The resource of the scene called `name`.
std::string find_scene(const std::string& name) {
  std::vector<std::string> known;
  for (const std::string& resource : scene_resources()) {
    known.push_back(fs::path(resource).stem().string());
    if (known.back() == name) return resource;
  }
  const std::string near = nearest_name(name, known);
  const std::string hint =
      !near.empty() ? fmt::format("did you mean '{}'?", near) : fmt::format("there are {}", fmt::join(known, ", "));
  throw InputError(fmt::format("unknown scene '{}'; {} (a file's name must end in .toml)", name, hint));
}

}  // namespace

std::vector<SceneInfo> list_scenes() {
  std::vector<SceneInfo> scenes;
  for (const std::string& resource : scene_resources()) {
    const fs::path path(resource);
    SceneInfo& info = scenes.emplace_back();
    info.name = path.stem().string();
    info.module = path.parent_path().parent_path().filename().string();
    try {
      const toml::table document = toml::parse(find_resource(resource).value_or(""), resource);
      info.title = document["title"].value_or(std::string());
      info.description = document["description"].value_or(std::string());
    } catch (const toml::parse_error& error) {
      const toml::source_position at = error.source().begin;
      throw InputError(fmt::format("{}:{}:{}: {}", resource, at.line, at.column, error.description()));
    }
  }
  return scenes;
}

Scene load_scene(const std::string& name_or_path) {
  auto description = std::make_unique<SceneDescription>();
  std::string text;
  fs::path folder;
  if (name_or_path.ends_with(".toml")) {
    description->file.shown = name_or_path;
    text = read_toml_text(name_or_path, "scene", kMaxSceneBytes);
    folder = fs::path(name_or_path).parent_path();
  } else {
    description->file.shown = find_scene(name_or_path);
    text = find_resource(description->file.shown).value_or("");
    folder = fs::path(description->file.shown).parent_path();  // names it in messages; a built-in scene has assets alone
  }
  const std::string name = fs::path(description->file.shown).stem().string();
  parse_scene(text, folder, *description);
  Scene scene;
  scene.name = name;
  scene.source = std::make_shared<SceneSource>(std::move(description), std::move(text));
  scene.source->evaluate_all(scene);
  return scene;
}

}  // namespace pellucid
