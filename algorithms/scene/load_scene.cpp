#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "algorithms/scene/loading_facts.hpp"
#include "algorithms/scene/meshes/mesh_file.hpp"
#include "algorithms/scene/scene.hpp"
#include "algorithms/scene/toml/scene_source.hpp"
#include "gl/resources/resources.hpp"

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

/// The world's coordinates have 32 bits: far from the origin an object loses its shape.
void warn_of_rounding(Scene& scene) {
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
    if (mesh.positions.empty()) continue;
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
    for (const glm::vec3& p : mesh.positions) {
      const glm::dvec3 at(glm::dmat4(instance.to_world) * glm::dvec4(glm::dvec3(p), 1));
      low = glm::min(low, at);
      high = glm::max(high, at);
    }
    const double share = rounding_share(low, high);
    if (share <= 1e-3) continue;
    scene.source->facts().warnings.push_back(
        fmt::format("{}: instances.{} lies so far from the origin that 32 bits move its points by up to {:.2g} of its "
                    "extent",
                    scene.name, instance.name, share));
  }
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

const LoadingFacts& loading_facts(const Scene& scene) {
  return scene.source->facts();
}

Scene load_scene(const std::string& name_or_path) {
  auto description = std::make_unique<SceneDescription>();
  std::string text;
  fs::path folder;
  if (name_or_path.ends_with(".toml")) {
    description->file.shown = name_or_path;
    text = read_toml_text(name_or_path, "scene", kMaxSceneBytes);
    description->facts.files.emplace_back(name_or_path);
    folder = fs::path(name_or_path).parent_path();
  } else {
    description->file.shown = find_scene(name_or_path);
    text = find_resource(description->file.shown).value_or("");
    folder =
        fs::path(description->file.shown).parent_path();  // names it in messages; a built-in scene has assets alone
  }
  const std::string name = fs::path(description->file.shown).stem().string();
  parse_scene(text, folder, *description);
  Scene scene;
  scene.name = name;
  scene.source = std::make_shared<SceneSource>(std::move(description), std::move(text));
  scene.source->evaluate_all(scene);
  warn_of_rounding(scene);
  return scene;
}

}  // namespace pellucid
