#include <cstddef>

#include <fmt/format.h>

#include "algorithms/scene/toml/scene_description.hpp"

namespace pellucid {

namespace {

void parse_light_direction(TableReader& reader, LightDescription& light) {
  for (const char* key : {"azimuth_deg", "elevation_deg"}) {
    for (const char* other : {"direction", "direction_path"})
      reader.exclude(key, other);
  }
  light.by_angles = reader.has("azimuth_deg") || reader.has("elevation_deg");
  if (light.by_angles) {
    reader.number("azimuth_deg", light.azimuth_deg, kAngleDeg);
    reader.number("elevation_deg", light.elevation_deg, {-90, 90});
  } else {
    parse_position(reader, "direction", light.direction, light.direction_path, Need::required);
  }
  light.spin = parse_spin(reader);
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
    reader.boolean("shadow", light.casts_shadow);
    reader.finish();
    if (light.animated()) scene.animated.push_back(affected);
  }
}

}  // namespace pellucid
