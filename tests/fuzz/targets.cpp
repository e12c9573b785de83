#include "tests/fuzz/targets.hpp"

#include <cassert>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "algorithms/scene/images/environment_layout.hpp"
#include "algorithms/scene/images/picture_file.hpp"
#include "algorithms/scene/meshes/mesh_file.hpp"
#include "algorithms/scene/toml/scene_description.hpp"
#include "algorithms/scene/volumes/volume_file.hpp"
#include "gl/display/display.hpp"
#include "gl/error.hpp"
#include "sweeps/papers/paper.hpp"
#include "sweeps/spec/spec.hpp"
#include "sweeps/store/store.hpp"

namespace pellucid::fuzz {
namespace {

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void read_mesh(const std::filesystem::path& path) {
  MeshFile file = load_mesh_file(path, 60);
  restore_origin(file);
}

void read_volume(const std::filesystem::path& path) {
  normalise(load_volume_file(path), glm::dvec2(0, 1));
}

void read_environment(const std::filesystem::path& path) {
  PictureFile file = read_picture(path);
  encode_as_srgb(file);
  std::vector<std::string> warnings;
  to_lat_long(std::move(file), std::nullopt, 1e9, warnings);
}

/// Parsed and not evaluated: a scene may ask for as much work as it likes.
void read_scene(const std::filesystem::path& path) {
  SceneDescription description;
  description.file.shown = path.string();
  parse_scene(text_of(path), path.parent_path(), description);
}

void read_store(const std::filesystem::path& path) {
  const sweeps::Store store(path, sweeps::Access::read);
  store.status();
  store.rows(true);
}

void read_display_config(const std::filesystem::path& path) {
  ::setenv("OCIO", path.c_str(), 1);
  std::vector<float> pixel{0.1F, 1.0F, 4.0F};
  gl::DisplayTransform("", "").apply(pixel, 3);
}

}  // namespace

std::span<const Target> targets() {
  static const std::vector<Target> all = {
      {"ply", ".ply", read_mesh},
      {"off", ".off", read_mesh},
      {"obj", ".obj", read_mesh},
      {"gltf", ".gltf", read_mesh},
      {"glb", ".glb", read_mesh},
      {"3ds", ".3ds", read_mesh},
      {"vti", ".vti", read_volume},
      {"mha", ".mha", read_volume},
      {"nrrd", ".nrrd", read_volume},
      {"inr", ".inr", read_volume},
      {"exr", ".exr", read_environment},
      {"png", ".png", read_environment},
      {"scene", ".toml", read_scene},
      {"spec", ".toml", [](const std::filesystem::path& path) { sweeps::parse_spec(text_of(path), path.string()); }},
      {"paper", ".toml", [](const std::filesystem::path& path) { sweeps::load_paper(path.string()); }},
      {"store", ".db", read_store},
      {"ocio", ".ocio", read_display_config},
  };
  return all;
}

const Target& target(std::string_view name) {
  for (const Target& t : targets())
    if (t.name == name) return t;
  assert(false && "no such target");
  std::abort();
}

void run(const Target& target, const std::filesystem::path& folder, std::string_view bytes) {
  const std::filesystem::path path = folder / ("input" + std::string(target.extension));
  {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  try {
    target.read(path);
  } catch (const InputError&) {
  } catch (const RuntimeError&) {
  }
}

}  // namespace pellucid::fuzz
