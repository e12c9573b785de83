#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "algorithms/scene/files/hash.hpp"
#include "algorithms/scene/toml/scene_description.hpp"

namespace pellucid {

namespace {

constexpr const char* kPlacementKeys[] = {"center",       "center_path",   "size", "fit_m",
                                          "rotation_deg", "rotation_axis", "spin"};

void parse_noise(TableReader& reader, VolumeDescription& volume) {
  reader.integer("seed", volume.seed, {0, 4294967295.0});
  reader.integer("octaves", volume.octaves, {1, 12});
  reader.number("frequency", volume.frequency, {0, 1000});
  reader.number("contrast", volume.contrast, kShare);
}

/// The keys of one kind of voxels.
void parse_voxels(TableReader& reader, VolumeDescription& volume) {
  reader.extent("voxels", volume.voxels, {1, kMaxVoxelsPerAxis}, true);
  reader.number("density", volume.density, {0, 1e6});
  switch (volume.kind) {
    case VolumeKind::fog:
      parse_noise(reader, volume);
      reader.number("height_falloff", volume.height_falloff, {0, 100});
      break;
    case VolumeKind::smoke:
      volume.frequency = 4;
      volume.contrast = 0.8;
      parse_noise(reader, volume);
      reader.number("swirl", volume.swirl, kShare);
      break;
    case VolumeKind::water:
      volume.octaves = 2;
      volume.frequency = 2;
      volume.contrast = 0.2;
      parse_noise(reader, volume);
      reader.number("depth_gradient", volume.depth_gradient, kShare);
      reader.number("level", volume.level, kShare);
      reader.number("wave", volume.wave, {0, 0.5});
      break;
    case VolumeKind::constant:
    case VolumeKind::ball:
    case VolumeKind::file:
      break;
  }
}

/// Voxels from a file, whose spacing in metres tells the box's size unless the scene does.
void parse_voxel_file(TableReader& reader, const std::filesystem::path& folder, VolumeDescription& volume,
                      SceneDescription& scene) {
  const std::filesystem::path path = parse_file_name(reader, "file", folder, scene);
  std::optional<glm::dvec2> range;
  constexpr double kMost = std::numeric_limits<double>::max();
  if (reader.has("range")) reader.pair("range", range.emplace(0.0), {-kMost, kMost}, false);
  if (range && !(range->x < range->y)) reader.fail("range", fmt::format("[{}, {}] is empty", range->x, range->y));
  const VolumeFile file = located(reader, "file", [&] { return load_volume_file(path); });
  for (const std::filesystem::path& other : file.files) {
    if (other == path) continue;
    scene.files_read.emplace_back(other.filename().string(), sha256_file(other));
    scene.facts.files.push_back(other);
  }
  volume.from_file = located(reader, "file", [&] { return normalise(file, range); });
  volume.voxels = glm::dvec3(file.size);
  volume.size = file.spacing * glm::dvec3(file.size);
}

/// The size of a box around the voxels of a file.
void parse_file_size(TableReader& reader, VolumeDescription& volume) {
  reader.exclude("fit_m", "size");
  if (reader.has("fit_m")) {
    const std::optional<Affected> none;
    double longest_m = 1;
    reader.set_affected(none);
    reader.number("fit_m", longest_m, kLength);
    reader.set_affected(Affected{Part::medium, 0});
    volume.size *= longest_m / std::max({volume.size.x, volume.size.y, volume.size.z});
  }
  for (int c = 0; c < 3; ++c) {
    if (reader.has("size") || kLength.contains(volume.size[c])) continue;
    reader.fail("file", fmt::format("its spacing makes the box {} x {} x {} m, out of {}; give size or fit_m",
                                    volume.size.x, volume.size.y, volume.size.z, kLength.text()));
  }
  if (!reader.has("fit_m")) reader.extent("size", volume.size, kLength, false);
}

void parse_box(TableReader& reader, VolumeDescription& volume) {
  volume.by_corners = reader.has("min") || reader.has("max");
  for (const char* corner : {"min", "max"}) {
    for (const char* key : kPlacementKeys)
      reader.exclude(key, corner);
  }
  if (volume.by_corners) {
    reader.vector("min", volume.min, kCoordinate, Need::required);
    reader.vector("max", volume.max, kCoordinate, Need::required);
    return;
  }
  parse_position(reader, "center", volume.placement.position, volume.placement.position_path, Need::required);
  if (volume.kind == VolumeKind::file) {
    parse_file_size(reader, volume);
  } else {
    reader.extent("size", volume.size, kLength, false, Need::required);
  }
  reader.vector("rotation_axis", volume.placement.rotation_axis, kCoordinate);
  reader.number("rotation_deg", volume.placement.rotation_deg, kAngleDeg);
  volume.placement.spin = parse_spin(reader);
}

/// A change to the light also changes the box, and a change to the cone also changes the voxels.
void connect_light(VolumeDescription& volume, SceneDescription& scene) {
  const auto light = static_cast<std::size_t>(volume.light);
  LightDescription& from = scene.lights[light];
  const Affected own{Part::light, light};
  for (DriveTarget& target : scene.targets) {
    if (target.affected == own) target.also.push_back({Part::medium, 0});
    for (const double* of_cone : {&from.inner_angle_deg, &from.outer_angle_deg, &volume.near_m, &volume.range_m,
                                  &volume.voxels.x, &volume.voxels.y, &volume.voxels.z}) {
      if (target.numbers.front() == of_cone) target.also.push_back({Part::scattering, 0});
    }
  }
  if (from.animated()) scene.animated.push_back({Part::medium, 0});
}

/// Imagire et al. 2007, Fig. 11: the box is the light's, not the file's.
void parse_light_space(TableReader& reader, VolumeDescription& volume, SceneDescription& scene) {
  for (const char* key : {"min", "max"})
    reader.exclude(key, "light");
  for (const char* key : kPlacementKeys)
    reader.exclude(key, "light");
  volume.light = find_named(reader, "light", scene.lights, "light");
  const LightDescription& light = scene.lights[static_cast<std::size_t>(volume.light)];
  if (light.kind != LightKind::spot) {
    reader.fail("light", fmt::format("'{}' is no spot light; a volume lies in the space of a spot", light.name));
  }
  reader.number("near_m", volume.near_m, {0.01, 1e6});
  reader.number("range_m", volume.range_m, kLength, Need::required);
}

void parse_transfer(TableReader& parent, VolumeDescription& volume) {
  for (TableReader& reader : parent.tables("transfer", Need::optional)) {
    reader.set_affected(Affected{Part::transfer, 0});
    TransferDescription& point = volume.transfer.emplace_back();
    point.place = reader.place();
    reader.number("density", point.density, {0, 1e6}, Need::required);
    reader.number("extinction", point.extinction, {0, 1e6}, Need::required);
    reader.color("albedo", point.albedo, kShare);
    reader.finish();
  }
  if (parent.has("transfer") && volume.transfer.size() < 2) {
    parent.fail("transfer", "a transfer function has at least two points");
  }
}

}  // namespace

void parse_volume(TableReader& root, const std::filesystem::path& folder, SceneDescription& scene) {
  std::optional<TableReader> reader = root.table("volume");
  if (!reader) return;
  VolumeDescription& volume = scene.volume.emplace();
  volume.name = "volume";
  volume.place = reader->place();

  reader->set_affected(Affected{Part::voxels, 0});
  reader->require("kind");
  volume.kind =
      static_cast<VolumeKind>(reader->choice("kind", {"constant", "fog", "ball", "smoke", "water", "file"}, 0));
  if (volume.kind == VolumeKind::file) {
    parse_voxel_file(*reader, folder, volume, scene);
  } else {
    parse_voxels(*reader, volume);
  }

  reader->set_affected(Affected{Part::medium, 0});
  if (reader->has("light")) {
    parse_light_space(*reader, volume, scene);
  } else {
    parse_box(*reader, volume);
  }
  reader->number("extinction", volume.extinction, {0, 1e6}, Need::required);
  reader->color("albedo", volume.albedo, kShare);
  reader->color("emission", volume.emission, kRadiance);
  parse_transfer(*reader, volume);
  reader->finish();
  if (volume.light >= 0) connect_light(volume, scene);
  if (volume.placement.position_path || volume.placement.spin) scene.animated.push_back({Part::medium, 0});
}

}  // namespace pellucid
