#include "plots/pictures/picture_sets.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <filesystem>
#include <string_view>
#include <tuple>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "algorithms/parameters.hpp"
#include "algorithms/render_session.hpp"
#include "algorithms/scene/images/image.hpp"
#include "algorithms/technique.hpp"
#include "gl/error.hpp"

namespace pellucid::plots {
namespace {

/// Runs `f`; what it refuses is told with the place of `key`.
template <class F>
void at(const TableReader& reader, std::string_view key, F&& f) {
  try {
    f();
  } catch (const InputError& e) {
    reader.fail(key, e.what());
  }
}

std::pair<int, int> read_size(TableReader& reader) {
  std::string text;
  reader.text("size", text, Need::required);
  int width = 0, height = 0;
  const char* const end = text.data() + text.size();
  const auto [x, first] = std::from_chars(text.data(), end, width);
  if (first != std::errc{} || x == end || *x != 'x') reader.fail("size", fmt::format("'{}' is not WIDTHxHEIGHT", text));
  const auto [rest, second] = std::from_chars(x + 1, end, height);
  if (second != std::errc{} || rest != end) reader.fail("size", fmt::format("'{}' is not WIDTHxHEIGHT", text));
  at(reader, "size", [&] { check_image_size(width, height, "size"); });
  return {width, height};
}

std::optional<Value> value_of(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* integer = node.as_integer()) return integer->get();
  if (const auto* real = node.as_floating_point()) return real->get();
  if (const auto* boolean = node.as_boolean()) return boolean->get();
  return std::nullopt;
}

/// The table that a setting of this name is in, and its name there; null for one of the scene.
std::pair<const ParameterTable*, std::string> owner_of(const std::string& name, const std::string& technique) {
  const std::size_t dot = name.find('.');
  if (dot == std::string::npos) return {&find_technique(technique).table(), name};
  for (const CommonSettings& group : common_settings()) {
    if (group.prefix == std::string_view(name).substr(0, dot)) return {group.table, name.substr(dot + 1)};
  }
  return {nullptr, name.substr(dot + 1)};
}

void read_settings(TableReader& reader, const std::string& prefix, const std::string& technique, Settings& out) {
  for (const std::string& key : reader.keys()) {
    const toml::node& node = *reader.node(key);
    if (node.is_table()) {
      TableReader group = *reader.table(key);
      read_settings(group, fmt::format("{}{}.", prefix, key), technique, out);
      continue;
    }
    const std::string name = prefix + key;
    const auto value = value_of(node);
    if (!value) reader.fail(key, "a setting is a boolean, a number or a string");
    if (technique.empty() && !name.starts_with("scene."))
      reader.fail(key, "the settings of a set are of its scene: scene.NAME");
    // A scene's contents are known when it is loaded, which takes its meshes.
    if (!technique.empty() && !name.starts_with("scene.")) {
      const auto [table, bare] = owner_of(name, technique);
      if (table == nullptr) reader.fail(key, fmt::format("'{}' is no setting", name));
      at(reader, key, [&, &owner = *table, &own = bare] {
        const ParameterInfo* info = owner.find(own);
        if (info == nullptr) throw unknown_parameter(own, technique, owner.infos());
        checked(*info, *value, technique);
      });
    }
    out.emplace_back(name, to_text(*value));
  }
}

PictureRecipe read_recipe(TableReader& reader) {
  PictureRecipe recipe;
  reader.text("name", recipe.name, Need::required);
  if (!is_name(recipe.name) || recipe.name == "reference")
    reader.fail("name", fmt::format("'{}' is not a name of a-z, 0-9 and _ other than reference", recipe.name));
  reader.text("label", recipe.label);
  reader.text("technique", recipe.technique, Need::required);
  at(reader, "technique", [&] { find_technique(recipe.technique); });
  if (auto settings = reader.table("settings")) read_settings(*settings, "", recipe.technique, recipe.settings);
  reader.text("role", recipe.role);
  reader.text("map", recipe.map);
  if (!recipe.map.empty() && !find_technique(recipe.technique).maps)
    reader.fail("map", fmt::format("{} does not tell its errors by pixel", recipe.technique));
  reader.finish();
  return recipe;
}

void read_close_up(TableReader& reader, PictureSet& set) {
  set.close_up = {};
  set.close_up_of.clear();
  reader.text("of", set.close_up_of);
  std::tie(set.close_up.width, set.close_up.height) = read_size(reader);
  reader.exclude("of", "x");
  if (!reader.has("of")) {
    double x = 0, y = 0;
    reader.integer("x", x, {0, 16'384}, Need::required);
    reader.integer("y", y, {0, 16'384}, Need::required);
    set.close_up.x = static_cast<int>(x);
    set.close_up.y = static_cast<int>(y);
    reader.text("why", set.close_up_why, Need::required);
  }
  reader.finish();
  const bool inside =
      set.close_up.x + set.close_up.width <= set.width && set.close_up.y + set.close_up.height <= set.height;
  if (!inside) reader.fail("size", "the close-up reaches beyond the picture");
}

void read_reference(TableReader& reader, PictureSet& set) {
  constexpr const char* kSurfaces[] = {"rays", "raster", "forward"};
  set.surfaces = kSurfaces[reader.choice("surfaces", {"rays", "raster", "forward"}, 0)];
  double samples = set.samples;
  reader.integer("samples", samples, {1, 65'536});
  set.samples = static_cast<int>(samples);
  reader.integer("preview_samples", samples, {1, 65'536});
  set.preview_samples = static_cast<int>(samples);
  reader.boolean("caustics", set.caustics);
  for (const char* key : {"samples", "preview_samples", "caustics"}) {
    if (reader.has(key) && set.surfaces != "rays") reader.fail(key, "goes with surfaces = \"rays\"");
  }
  reader.finish();
}

PictureSet read_set(TableReader& reader, const sweeps::Paper& paper, const std::vector<PictureSet>& before) {
  PictureSet set;
  std::string same_as;
  reader.text("same_as", same_as);
  if (!same_as.empty()) {
    const auto found =
        std::find_if(before.begin(), before.end(), [&](const PictureSet& s) { return s.name == same_as; });
    if (found == before.end()) reader.fail("same_as", fmt::format("no set '{}' stands before this one", same_as));
    set = *found;
  }
  const Need need = same_as.empty() ? Need::required : Need::optional;
  reader.text("name", set.name, Need::required);
  reader.text("title", set.title, Need::required);
  reader.text("scene", set.scene, need);
  reader.text("preview_scene", set.preview_scene);
  if (!paper.built_in) {
    for (std::string* scene : {&set.scene, &set.preview_scene}) {
      const std::filesystem::path path(*scene);
      if (scene->ends_with(".toml") && path.is_relative() &&
          reader.has(scene == &set.scene ? "scene" : "preview_scene"))
        *scene = (std::filesystem::path(paper.file.shown).parent_path() / path).lexically_normal().string();
    }
  }
  reader.text("view", set.view);
  if (auto settings = reader.table("settings")) {
    set.settings.clear();
    read_settings(*settings, "", "", set.settings);
  }
  if (need == Need::required || reader.has("size")) std::tie(set.width, set.height) = read_size(reader);
  if (auto reference = reader.table("reference")) read_reference(*reference, set);
  if (auto recipes = reader.tables("shown", need); !recipes.empty()) {
    set.pictures.clear();
    for (TableReader& recipe : recipes) {
      set.pictures.push_back(read_recipe(recipe));
      const auto twice = std::count_if(set.pictures.begin(), set.pictures.end(),
                                       [&](const PictureRecipe& p) { return p.name == set.pictures.back().name; });
      if (twice > 1) recipe.fail("name", fmt::format("'{}' comes twice", set.pictures.back().name));
    }
  }
  if (auto close_up = reader.table("close_up")) read_close_up(*close_up, set);
  const bool placed = set.close_up_of.empty() || std::any_of(set.pictures.begin(), set.pictures.end(),
                                                             [&](const auto& p) { return p.name == set.close_up_of; });
  if (!placed) reader.fail("close_up", fmt::format("the set has no picture '{}'", set.close_up_of));
  reader.finish();
  return set;
}

}  // namespace

std::vector<PictureSet> read_pictures(const sweeps::Paper& paper) {
  std::vector<PictureSet> sets;
  sweeps::entry_names(paper, "pictures");  // each has a name of its own
  TableReader root = paper.read();
  for (TableReader& reader : root.tables("pictures"))
    sets.push_back(read_set(reader, paper, sets));
  return sets;
}

}  // namespace pellucid::plots
