#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "algorithms/scene/files/asset_path.hpp"
#include "algorithms/scene/files/hash.hpp"
#include "algorithms/scene/images/environment_layout.hpp"
#include "algorithms/scene/toml/scene_description.hpp"

namespace pellucid {

void parse_scene(std::string_view text, const std::filesystem::path& folder, SceneDescription& scene) {
  const auto document = parse_toml(text, scene.file);
  TableReader root(scene.file, *document, "", scene.targets);
  root.text("title", scene.title, Need::required);
  root.text("description", scene.description);
  root.text("stand_in", scene.stand_in);
  root.set_affected(Affected{Part::ambient, 0});
  root.color("ambient", scene.ambient, kRadiance);
  root.set_affected(std::nullopt);
  parse_materials(root, scene);
  parse_meshes(root, folder, scene);
  parse_reliefs(root, folder, scene);
  parse_instances(root, scene);
  parse_forest(root, scene);
  parse_lights(root, scene);
  parse_volume(root, folder, scene);
  parse_environment(root, folder, scene);
  parse_views(root, scene);
  parse_parameters(root, scene);
  root.finish();
}

void SceneDescription::warn(const TableReader& reader, std::string_view key, std::string_view message) {
  const FilePosition place = reader.place(key);
  facts.warnings.push_back(
      fmt::format("{}:{}:{}: {}.{}: {}", file.shown, place.line, place.column, reader.path(), key, message));
}

std::filesystem::path parse_file_name(TableReader& reader, std::string_view key, const std::filesystem::path& folder,
                                      SceneDescription& scene) {
  std::string reference;
  reader.text(key, reference, Need::required);
  return located(reader, key, [&] {
    std::filesystem::path path = resolve_asset(reference, folder);
    scene.files_read.emplace_back(reference, sha256_file(path));
    scene.facts.files.push_back(path);
    return path;
  });
}

void parse_views(TableReader& root, SceneDescription& scene) {
  root.require("views");
  for (auto& [name, reader] : root.named_tables("views")) {
    const Affected affected{Part::view, scene.views.size()};
    ViewDescription& view = scene.views.emplace_back();
    view.name = name;
    view.place = reader.place();
    reader.set_affected(affected);
    parse_position(reader, "eye", view.eye, view.eye_path, Need::required);
    parse_position(reader, "target", view.target, view.target_path, Need::required);
    reader.vector("up", view.up, kCoordinate);
    reader.number("fov_y_deg", view.fov_y_deg, {0, 179, true});
    reader.number("near_m", view.near_m, kLength);
    reader.number("far_m", view.far_m, kLength);
    view.spin = parse_spin(reader);
    reader.finish();
    if (view.eye_path || view.target_path || view.spin) scene.animated.push_back(affected);
  }
  if (scene.views.empty()) root.fail("views", "a scene has at least one view");
}

void parse_environment(TableReader& root, const std::filesystem::path& folder, SceneDescription& scene) {
  std::optional<TableReader> reader = root.table("environment");
  if (!reader) return;
  EnvironmentDescription& environment = scene.environment;
  reader->set_affected(Affected{Part::environment, 0});
  reader->number("scale", environment.scale, {0, 1e6});
  for (const char* key : {"zenith", "horizon", "ground"})
    reader->exclude("image", key);
  if (reader->has("image")) {
    const std::filesystem::path path = parse_file_name(*reader, "image", folder, scene);
    std::optional<EnvironmentLayout> layout;
    if (reader->has("layout")) {
      layout = static_cast<EnvironmentLayout>(
          reader->choice("layout", {"lat_long", "cube_strip", "cube_cross", "mirror_ball", "angular"}, 0));
    }
    PictureFile file = located(*reader, "image", [&] { return read_picture(path, no_layer); });
    if (file.display_encoded) reader->fail("image", "an environment is scene-linear: an EXR file, not PNG");
    std::vector<std::string> warnings;
    environment.image =
        located(*reader, "image", [&] { return to_lat_long(std::move(file), layout, kRadiance.max, warnings); });
    for (const std::string& warning : warnings)
      scene.warn(*reader, "image", warning);
  } else {
    reader->color("zenith", environment.zenith, kRadiance);
    reader->color("horizon", environment.horizon, kRadiance);
    reader->color("ground", environment.ground, kRadiance);
  }
  reader->finish();
}

}  // namespace pellucid
