#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "algorithms/scene/relief/map_file.hpp"
#include "algorithms/scene/relief/rain.hpp"
#include "algorithms/scene/toml/scene_description.hpp"

/// Height-mapped surfaces.
namespace pellucid {
namespace {

constexpr NumberRange kHeight{-1e3, 0};
constexpr NumberRange kTexels{1, 2048};
constexpr NumberRange kSeed{0, 4294967295.0};
constexpr NumberRange kCells{1, 256};

ImageFile read_map(TableReader& reader, std::string_view key, const std::filesystem::path& folder,
                   SceneDescription& scene) {
  const std::filesystem::path path = parse_file_name(reader, key, folder, scene);
  return located(reader, key, [&] { return load_map(path); });
}

void parse_files(TableReader& reader, const std::filesystem::path& folder, ReliefLayerDescription& layer,
                 SceneDescription& scene) {
  reader.set_affected(std::nullopt);
  if (reader.has("file")) {
    const auto channel = static_cast<MapChannel>(reader.choice("channel", {"red", "green", "blue", "alpha"}, 0));
    const ImageFile file = read_map(reader, "file", folder, scene);
    layer.heights = located(reader, "file", [&] { return height_map(file, channel); });
  }
  if (reader.has("normals")) {
    bool flip_green = false;
    reader.boolean("flip_green", flip_green);
    const ImageFile file = read_map(reader, "normals", folder, scene);
    layer.normals = located(reader, "normals", [&] { return normal_map(file, flip_green); });
  }
  if (reader.has("colors")) {
    const ImageFile file = read_map(reader, "colors", folder, scene);
    layer.colors = located(reader, "colors", [&] { return color_map(file); });
  }
}

void parse_shape(TableReader& reader, ReliefLayerDescription& layer) {
  reader.require("shape");
  static constexpr Pattern kKinds[] = {Pattern::flat, Pattern::bricks, Pattern::stones, Pattern::noise, Pattern::cells,
                                       Pattern::gems, Pattern::waves,  Pattern::drops,  Pattern::rain};
  layer.kind = kKinds[reader.choice(
      "shape", {"flat", "bricks", "stones", "noise", "cells", "gems", "waves", "drops", "rain"}, 0)];
  if (layer.kind == Pattern::flat) layer.texels = glm::dvec2(1.0);
  reader.pair("texels", layer.texels, kTexels, true);
  if (layer.kind != Pattern::flat) reader.integer("seed", layer.seed, kSeed);
  switch (layer.kind) {
    case Pattern::flat:
      reader.number("level", layer.level, kShare);
      break;
    case Pattern::stones:
    case Pattern::bricks:
      if (layer.kind == Pattern::stones) layer.columns = layer.rows = 8;
      reader.integer("columns", layer.columns, kCells);
      reader.integer("rows", layer.rows, kCells);
      reader.number("joint", layer.joint, {0, 0.9});
      reader.number("roughness", layer.roughness, kShare);
      reader.number("contrast", layer.contrast, kShare);
      break;
    case Pattern::noise:
      reader.integer("frequency", layer.frequency, kCells);
      reader.integer("octaves", layer.octaves, {1, 8});
      reader.number("contrast", layer.contrast, kShare);
      break;
    case Pattern::cells:
      layer.columns = layer.rows = 6;
      reader.integer("columns", layer.columns, kCells);
      reader.integer("rows", layer.rows, kCells);
      reader.number("joint", layer.joint, {0, 0.9});
      reader.number("level", layer.level, kShare);
      break;
    case Pattern::waves:
      reader.integer("frequency", layer.frequency, kCells);
      reader.integer("waves", layer.waves, {1, kMostSines});
      reader.number("size_m", layer.size_m, kLength);
      break;
    case Pattern::drops:
      layer.columns = layer.rows = 8;
      reader.integer("columns", layer.columns, kCells);
      reader.integer("rows", layer.rows, kCells);
      reader.number("share", layer.share, kShare);
      reader.number("radius", layer.radius, {0.01, 1});
      reader.number("height", layer.height_m, kLength);
      break;
    case Pattern::gems:
      layer.columns = layer.rows = 1;
      reader.integer("columns", layer.columns, kCells);
      reader.integer("rows", layer.rows, kCells);
      reader.number("level", layer.level, kShare);
      break;
    case Pattern::rain:
      layer.radius = 0.05;
      reader.integer("drops", layer.drops, {1, kMostRainDrops});
      reader.number("radius", layer.radius, {0.005, 0.09});
      reader.integer("fall", layer.fall, {0, 256});
      reader.number("height", layer.height_m, kLength);
      break;
    case Pattern::file:
      break;
  }
}

void parse_layer(TableReader& reader, const std::filesystem::path& folder, std::size_t index, bool translucent,
                 ReliefLayerDescription& layer, SceneDescription& scene) {
  reader.set_affected(Affected{Part::relief_maps, index});
  reader.exclude("shape", "file");
  if (reader.has("file"))
    layer.kind = Pattern::file;
  else
    parse_shape(reader, layer);
  const bool on_solid = layer.kind == Pattern::drops || layer.kind == Pattern::rain;
  if (on_solid && !translucent) reader.fail("shape", "drops lie on a solid: they are translucent");
  if (!on_solid) {
    reader.number("low", layer.low_m, kHeight);
    reader.number("high", layer.high_m, kHeight);
  }
  reader.set_affected(Affected{Part::relief, index});
  if (!translucent) reader.color("albedo", layer.albedo, kShare);
  reader.number("specular", layer.specular, {0, 1000});
  reader.number("exponent", layer.exponent, {1, 1e5});
  parse_files(reader, folder, layer, scene);
  if (translucent && layer.colors.width > 0) reader.fail("colors", "a medium has no colours; give it a half_depth");
}

void parse_air(TableReader& reader, std::size_t index, ReliefAirDescription& air) {
  reader.set_affected(Affected{Part::relief_maps, index});
  reader.number("height", air.height_m, kLength);
  reader.number("ground_index", air.ground_index, kRefractiveIndex);
  reader.number("index", air.index, kRefractiveIndex);
  air.exponential = reader.choice("profile", {"linear", "exponential"}, 0) == 1;
  if (air.exponential) reader.number("falloff", air.falloff_m, kLength);
  reader.number("turbulence", air.turbulence, kShare);
  reader.integer("seed", air.seed, kSeed);
  reader.extent("texels", air.texels, {2, 256}, true);
  reader.finish();
}

}  // namespace

void parse_reliefs(TableReader& root, const std::filesystem::path& folder, SceneDescription& scene) {
  for (auto& [name, reader] : root.named_tables("reliefs")) {
    const std::size_t index = scene.reliefs.size();
    ReliefDescription& relief = scene.reliefs.emplace_back();
    relief.name = name;
    relief.place = reader.place();
    reader.set_affected(Affected{Part::relief, index});
    reader.vector("tiling", relief.tiling, {1e-3, 1e4});
    relief.cut = reader.choice("edges", {"cut", "repeat"}, 0) == 0;
    reader.require("solid");
    std::optional<TableReader> solid = reader.table("solid");
    parse_layer(*solid, folder, index, false, relief.solid, scene);
    solid->finish();
    bool animated = relief.solid.kind == Pattern::waves;
    if (std::optional<TableReader> medium = reader.table("translucent")) {
      ReliefLayerDescription& layer = relief.translucent.emplace();
      parse_layer(*medium, folder, index, true, layer, scene);
      medium->set_affected(Affected{Part::relief, index});
      medium->number("outside_index", relief.outside_index, kRefractiveIndex);
      medium->number("index", relief.index, kRefractiveIndex);
      medium->number("intensification", relief.intensification, kShare);
      medium->color("half_depth", relief.half_depth_m, kLength);
      medium->color("scattering", relief.scattering, {0, 1e6});
      medium->number("anisotropy", relief.anisotropy, {-0.99, 0.99});
      medium->finish();
      animated = animated || layer.kind == Pattern::waves || layer.kind == Pattern::rain;
    }
    if (std::optional<TableReader> air = reader.table("air")) {
      parse_air(*air, index, relief.air.emplace());
      animated = animated || relief.air->turbulence > 0;
    }
    reader.finish();
    if (animated) scene.animated.push_back({Part::relief_maps, index});
  }
}

void carry_relief(TableReader& reader, const SceneDescription& scene, InstanceDescription& instance) {
  instance.relief = find_named(reader, "relief", scene.reliefs, "relief");
  if (scene.materials[static_cast<std::size_t>(instance.material)].kind != SurfaceKind::lambertian)
    reader.fail("relief", "what lies on a relief is not a mirror, a metal or a dielectric: its material is lambertian");
}

}  // namespace pellucid
