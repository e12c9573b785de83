#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "algorithms/scene/shapes/procedural.hpp"
#include "algorithms/scene/toml/scene_description.hpp"

/// The volume's voxels, its box and its medium.
namespace pellucid {

namespace {

// ---- the box of a light's space ----

/// Beyond it the box is so wide that few of its voxels lie in the cone.
constexpr double kMaxConeAngleDeg = 80;

/// Turns straight down into `direction` the shortest way, so that the box does not jump about its axis as the light
/// moves.
glm::dmat3 turn_from_down(const glm::dvec3& direction) {
  const glm::dvec3 down(0, -1, 0);
  const double cosine = glm::dot(down, direction);
  if (cosine < -1 + 1e-12) return rotation({1, 0, 0}, 180);
  const glm::dvec3 v = glm::cross(down, direction);
  const glm::dmat3 cross(0, v.z, -v.y, -v.z, 0, v.x, v.y, -v.x, 0);
  return glm::dmat3(1.0) + cross + cross * cross / (1 + cosine);
}

/// Local z runs along the light from near_m to range_m, x and y across the cone's widest section.
glm::dmat4 light_space(const VolumeDescription& from, const LightDescription& cone, const Light& light) {
  const double half = from.range_m * std::tan(glm::radians(cone.outer_angle_deg));
  const glm::dvec3 direction = glm::normalize(glm::dvec3(light.direction));
  const glm::dmat3 turned = turn_from_down(direction);
  glm::dmat4 to_world(1.0);
  to_world[0] = glm::dvec4(turned * glm::dvec3(2 * half, 0, 0), 0);
  to_world[1] = glm::dvec4(turned * glm::dvec3(0, 0, 2 * half), 0);
  to_world[2] = glm::dvec4(direction * (from.range_m - from.near_m), 0);
  const glm::dvec3 corner =
      glm::dvec3(light.position) + direction * from.near_m - 0.5 * (glm::dvec3(to_world[0]) + glm::dvec3(to_world[1]));
  to_world[3] = glm::dvec4(corner, 1.0);
  return to_world;
}

void check_cone(const SceneDescription& description, const LightDescription& light) {
  const VolumeDescription& from = *description.volume;
  if (!(from.near_m < from.range_m)) {
    throw description.file.error(from.place,
                                 fmt::format("volume: near_m {} must be below range_m {}", from.near_m, from.range_m));
  }
  if (light.outer_angle_deg > kMaxConeAngleDeg) {
    throw description.file.error(
        light.place,
        fmt::format("lights.{}: outer_angle_deg {} is above {}, the widest for a volume in a light's space", light.name,
                    light.outer_angle_deg, kMaxConeAngleDeg));
  }
}

// ---- the box of the file ----

glm::dmat4 given_box(const SceneDescription& description, double time_s) {
  const VolumeDescription& from = *description.volume;
  glm::dmat3 edges(1.0);
  glm::dvec3 corner = from.min;
  glm::dvec3 size = from.size;
  if (from.by_corners) {
    size = from.max - from.min;
    if (!(size.x > 0 && size.y > 0 && size.z > 0)) {
      throw description.file.error(from.place, "volume: min must be below max along every axis");
    }
  } else {
    edges = turn(description, from.placement, from.place, time_s);
  }
  for (int c = 0; c < 3; ++c)
    edges[c] *= size[c];
  if (!from.by_corners) {
    corner = position_at(from.placement.position, from.placement.position_path, time_s) - edges * glm::dvec3(0.5);
  }
  glm::dmat4 to_world(edges);
  to_world[3] = glm::dvec4(corner, 1.0);
  return to_world;
}

std::vector<float> make_density(const VolumeDescription& from, const glm::ivec3& size) {
  const auto f = [](double v) { return static_cast<float>(v); };
  const auto seed = static_cast<std::uint32_t>(from.seed);
  const int octaves = whole(from.octaves);
  switch (from.kind) {
    case VolumeKind::constant:
    case VolumeKind::file:
      break;
    case VolumeKind::ball:
      return make_ball_density(size);
    case VolumeKind::fog:
      return make_fog_density(size, {seed, octaves, f(from.frequency), f(from.height_falloff), f(from.contrast)});
    case VolumeKind::smoke:
      return make_smoke_density(size, {seed, octaves, f(from.frequency), f(from.contrast), f(from.swirl)});
    case VolumeKind::water:
      return make_water_density(size, {seed, octaves, f(from.frequency), f(from.contrast), f(from.depth_gradient),
                                       f(from.level), f(from.wave)});
  }
  return make_constant_density(size, 1.0F);
}

}  // namespace

void evaluate_voxels(SceneDescription& description, Scene& scene) {
  VolumeDescription& from = *description.volume;
  const double count = from.voxels.x * from.voxels.y * from.voxels.z;
  if (count > static_cast<double>(kMaxVoxels)) {
    throw description.file.error(from.place, fmt::format("volume: {} x {} x {} voxels; at most 2^30 are allowed",
                                                         from.voxels.x, from.voxels.y, from.voxels.z));
  }
  Volume& volume = *scene.volume;
  volume.name = from.name;
  volume.size = glm::ivec3(whole(from.voxels.x), whole(from.voxels.y), whole(from.voxels.z));
  if (from.kind == VolumeKind::file) {
    if (from.from_file) {
      volume.density = std::move(from.from_file->values);
      volume.file_range = glm::vec2(from.from_file->range);
      description.facts.file_range = from.from_file->range;
    }
    from.from_file.reset();
    return;
  }
  volume.density = make_density(from, volume.size);
  const auto density = static_cast<float>(from.density);
  if (density == 1.0F) return;
  for (float& d : volume.density)
    d *= density;
}

void evaluate_scattering(const SceneDescription& description, Scene& scene) {
  const VolumeDescription& from = *description.volume;
  if (from.light < 0) return;
  const LightDescription& light = description.lights[static_cast<std::size_t>(from.light)];
  check_cone(description, light);
  ConeShape cone;
  cone.near_m = from.near_m;
  cone.range_m = from.range_m;
  cone.inner_angle_deg = light.inner_angle_deg;
  cone.outer_angle_deg = light.outer_angle_deg;
  scene.volume->scattering = make_cone_scattering(scene.volume->size, cone);
}

void evaluate_transfer(const SceneDescription& description, Scene& scene) {
  Volume& volume = *scene.volume;
  volume.transfer.clear();
  for (const TransferDescription& point : description.volume->transfer) {
    const auto density = static_cast<float>(point.density);
    if (!volume.transfer.empty() && !(density > volume.transfer.back().density)) {
      throw description.file.error(
          point.place, fmt::format("volume.transfer[{}]: density {} does not follow {}; densities must rise",
                                   volume.transfer.size(), point.density, volume.transfer.back().density));
    }
    volume.transfer.push_back({density, static_cast<float>(point.extinction), glm::vec3(point.albedo)});
  }
}

void evaluate_medium(const SceneDescription& description, double time_s, Scene& scene) {
  const VolumeDescription& from = *description.volume;
  Volume& volume = *scene.volume;
  volume.light = from.light;
  if (from.light >= 0) {
    const auto light = static_cast<std::size_t>(from.light);
    check_cone(description, description.lights[light]);
    volume.to_world = glm::mat4(light_space(from, description.lights[light], scene.lights[light]));
  } else {
    volume.to_world = glm::mat4(given_box(description, time_s));
  }
  volume.extinction = static_cast<float>(from.extinction);
  volume.albedo = glm::vec3(from.albedo);
  volume.emission = glm::vec3(from.emission);
}

}  // namespace pellucid
