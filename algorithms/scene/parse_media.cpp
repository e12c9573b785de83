#include <fmt/format.h>

#include "algorithms/scene/scene_description.hpp"

/// Lights and the volume.
namespace pellucid {

namespace {

void parse_light_direction(TableReader& reader, LightDescription& light) {
  for (const char* key : {"azimuth_deg", "elevation_deg"})
    reader.exclude(key, "direction");
  light.by_angles = reader.has("azimuth_deg") || reader.has("elevation_deg");
  if (light.by_angles) {
    reader.number("azimuth_deg", light.azimuth_deg, kAngleDeg);
    reader.number("elevation_deg", light.elevation_deg, {-90, 90});
  } else {
    reader.vector("direction", light.direction, kCoordinate, Need::required);
  }
  light.spin = parse_spin(reader);
}

void parse_box(TableReader& reader, VolumeDescription& volume) {
  volume.by_corners = reader.has("min") || reader.has("max");
  for (const char* corner : {"min", "max"}) {
    for (const char* key : {"center", "center_path", "size", "rotation_deg", "rotation_axis", "spin"}) {
      reader.exclude(key, corner);
    }
  }
  if (volume.by_corners) {
    reader.vector("min", volume.min, kCoordinate, Need::required);
    reader.vector("max", volume.max, kCoordinate, Need::required);
    return;
  }
  parse_position(reader, "center", volume.placement.position, volume.placement.position_path, Need::required);
  reader.extent("size", volume.size, kLength, false, Need::required);
  reader.vector("rotation_axis", volume.placement.rotation_axis, kCoordinate);
  reader.number("rotation_deg", volume.placement.rotation_deg, kAngleDeg);
  volume.placement.spin = parse_spin(reader);
}

}  // namespace

void parse_lights(TableReader& root, SceneDescription& scene) {
  for (auto& [name, reader] : root.named_tables("lights")) {
    if (scene.lights.size() == static_cast<std::size_t>(kMaxLights)) {
      reader.fail(reader.place(), fmt::format("{}: a scene has at most {} lights", reader.path(), kMaxLights));
    }
    const Affected affected{Part::light, scene.lights.size()};
    reader.set_affected(affected);
    LightDescription& light = scene.lights.emplace_back();
    light.name = name;
    light.place = reader.place();
    reader.require("kind");
    light.kind = static_cast<LightKind>(reader.choice("kind", {"directional", "point", "spot"}, 0));
    if (light.kind != LightKind::directional) {
      parse_position(reader, "position", light.position, light.position_path, Need::required);
    }
    if (light.kind != LightKind::point) parse_light_direction(reader, light);
    if (light.kind == LightKind::spot) {
      reader.number("inner_angle_deg", light.inner_angle_deg, {0, 90});
      reader.number("outer_angle_deg", light.outer_angle_deg, {0, 90});
    }
    reader.color("intensity", light.intensity, kRadiance, Need::required);
    reader.finish();
    if (light.position_path || light.spin) scene.animated.push_back(affected);
  }
}

void parse_volume(TableReader& root, SceneDescription& scene) {
  std::optional<TableReader> reader = root.table("volume");
  if (!reader) return;
  VolumeDescription& volume = scene.volume.emplace();
  volume.name = "volume";
  volume.place = reader->place();

  reader->set_affected(Affected{Part::voxels, 0});
  reader->require("kind");
  volume.kind = static_cast<VolumeKind>(reader->choice("kind", {"constant", "fog", "ball"}, 0));
  reader->extent("voxels", volume.voxels, {1, 2048}, true);
  reader->number("density", volume.density, {0, 1e6});
  if (volume.kind == VolumeKind::fog) {
    reader->integer("seed", volume.seed, {0, 4294967295.0});
    reader->integer("octaves", volume.octaves, {1, 12});
    reader->number("frequency", volume.frequency, {0, 1000});
    reader->number("height_falloff", volume.height_falloff, {0, 100});
    reader->number("contrast", volume.contrast, kShare);
  }

  reader->set_affected(Affected{Part::medium, 0});
  parse_box(*reader, volume);
  reader->number("extinction", volume.extinction, {0, 1e6}, Need::required);
  reader->color("albedo", volume.albedo, kShare);
  reader->color("emission", volume.emission, kRadiance);
  reader->finish();
  if (volume.placement.position_path || volume.placement.spin) scene.animated.push_back({Part::medium, 0});
}

}  // namespace pellucid
