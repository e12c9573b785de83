#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "algorithms/scene/shapes/procedural.hpp"
#include "algorithms/scene/toml/scene_description.hpp"

namespace pellucid {

namespace {

[[noreturn]] void contradict(const SceneDescription& scene, FilePosition place, std::string_view message) {
  throw scene.file.error(place, message);
}

// ---- geometry ----

Mesh make_shape(const SceneDescription& scene, const MeshDescription& mesh) {
  const auto f = [](double v) { return static_cast<float>(v); };
  const int segments = whole(mesh.segments);
  switch (mesh.kind) {
    case MeshKind::sphere:
      return make_sphere(f(mesh.radius), segments);
    case MeshKind::box:
      return make_box(glm::vec3(mesh.size));
    case MeshKind::plane:
      return make_plane(glm::vec2(mesh.plane_size), segments);
    case MeshKind::cylinder:
      return make_cylinder(f(mesh.radius), f(mesh.height), segments);
    case MeshKind::cone:
      return make_cone(f(mesh.radius), f(mesh.height), segments);
    case MeshKind::torus:
      if (!(mesh.minor_radius < mesh.radius)) {
        contradict(scene, mesh.place,
                   fmt::format("meshes.{}: minor_radius {} must be below radius {}", mesh.name, mesh.minor_radius,
                               mesh.radius));
      }
      return make_torus(f(mesh.radius), f(mesh.minor_radius), segments);
    case MeshKind::star:
      return make_star({f(mesh.radius), whole(mesh.lobes), f(mesh.amplitude)}, segments);
    case MeshKind::teapot:
      return make_teapot(f(mesh.scale), segments);
    case MeshKind::relief:
      return make_relief({glm::vec2(mesh.plane_size), segments, f(mesh.height), f(mesh.frequency), whole(mesh.octaves),
                          f(mesh.ripples), static_cast<std::uint32_t>(mesh.seed)});
    case MeshKind::tiles:
      return make_tiles({glm::vec2(mesh.plane_size), whole(mesh.columns), whole(mesh.rows), f(mesh.joint), mesh.running,
                         f(mesh.contrast), f(mesh.hue), static_cast<std::uint32_t>(mesh.seed)});
    case MeshKind::file:
      break;
  }
  return {};
}

void evaluate_mesh(SceneDescription& description, std::size_t i, Scene& scene) {
  MeshDescription& mesh = description.meshes[i];
  if (mesh.kind == MeshKind::file) {
    if (mesh.from_file) scene.meshes[i] = std::move(*mesh.from_file);
    mesh.from_file.reset();
  } else {
    scene.meshes[i] = make_shape(description, mesh);
  }
  scene.meshes[i].name = mesh.name;
}

template <class Things>
void check_distinct(const SceneDescription& description, const Things& things, std::string_view kind) {
  std::set<std::string_view> names;
  for (const auto& thing : things) {
    if (!names.insert(thing.name).second) {
      contradict(description, description.forest->place,
                 fmt::format("the forest makes a {} '{}', a name that the scene uses too", kind, thing.name));
    }
  }
}

/// The forest comes behind what the file declares, so the latter's indices never change.
void evaluate_forest(const SceneDescription& description, Scene& scene) {
  const ForestDescription& forest = *description.forest;
  scene.meshes.resize(description.meshes.size());
  scene.materials.resize(description.materials.size());
  scene.instances.resize(description.instances.size());
  ForestOptions options;
  options.extent = glm::vec2(forest.extent);
  options.trees = whole(forest.trees);
  options.clearing_radius = static_cast<float>(forest.clearing_radius);
  options.clearing = glm::vec2(forest.clearing);
  options.relief_m = static_cast<float>(forest.relief_m);
  options.seed = static_cast<std::uint32_t>(forest.seed);
  add_forest(scene, options);
  check_distinct(description, scene.meshes, "mesh");
  check_distinct(description, scene.materials, "material");
}

void evaluate_instance(const SceneDescription& description, std::size_t i, double time_s, Scene& scene) {
  const InstanceDescription& from = description.instances[i];
  glm::dmat3 axes = turn(description, from.placement, from.place, time_s);
  for (int c = 0; c < 3; ++c)
    axes[c] *= from.scale[c];
  glm::dmat4 to_world(axes);
  to_world[3] = glm::dvec4(position_at(from.placement.position, from.placement.position_path, time_s), 1.0);
  scene.instances[i] = {from.name,
                        from.mesh,
                        from.material,
                        glm::mat4(to_world),
                        glm::vec3(from.tint),
                        {from.cubes.begin(), from.cubes.end()},
                        from.relief};
}

// ---- lights and views ----

void evaluate_light(const SceneDescription& description, std::size_t i, double time_s, Scene& scene) {
  const LightDescription& from = description.lights[i];
  glm::dvec3 direction = position_at(from.direction, from.direction_path, time_s);
  if (from.by_angles) {
    // Where the light comes from: the azimuth turns from −z to +x, the elevation lifts towards +y.
    const double azimuth = glm::radians(from.azimuth_deg);
    const double elevation = glm::radians(from.elevation_deg);
    direction = -glm::dvec3(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                            -std::cos(elevation) * std::cos(azimuth));
  }
  if (glm::length(direction) < 1e-9) {
    contradict(description, from.place, fmt::format("lights.{}: direction must not be zero", from.name));
  }
  direction = glm::normalize(direction);
  if (from.spin) direction = from.spin->at(time_s) * direction;
  if (from.kind == LightKind::spot && !(from.inner_angle_deg < from.outer_angle_deg)) {
    contradict(description, from.place,
               fmt::format("lights.{}: inner_angle_deg {} must be below outer_angle_deg {}", from.name,
                           from.inner_angle_deg, from.outer_angle_deg));
  }
  scene.lights[i] = {from.name,
                     from.kind,
                     glm::vec3(position_at(from.position, from.position_path, time_s)),
                     glm::vec3(direction),
                     glm::vec3(from.intensity),
                     static_cast<float>(from.inner_angle_deg),
                     static_cast<float>(from.outer_angle_deg),
                     from.casts_shadow};
}

void evaluate_view(const SceneDescription& description, std::size_t i, double time_s, Scene& scene) {
  const ViewDescription& from = description.views[i];
  const auto refuse = [&](std::string_view message) {
    contradict(description, from.place, fmt::format("views.{}: {}", from.name, message));
  };
  const glm::dvec3 target = position_at(from.target, from.target_path, time_s);
  glm::dvec3 eye = position_at(from.eye, from.eye_path, time_s);
  if (from.spin) eye = target + from.spin->at(time_s) * (eye - target);
  if (!(from.near_m < from.far_m)) {
    refuse(fmt::format("near_m {} must be below far_m {}", from.near_m, from.far_m));
  }
  const double distance = glm::length(target - eye);
  if (!(distance > 1e-6)) refuse("eye and target are the same point");
  const double up_length = glm::length(from.up);
  if (!(up_length > 1e-9)) refuse("up must not be zero");
  const double sine = glm::length(glm::cross((target - eye) / distance, from.up / up_length));
  if (!(sine > 1e-6)) refuse("up is parallel to the line of sight");
  scene.views[i] = {from.name,
                    glm::vec3(eye),
                    glm::vec3(target),
                    glm::vec3(from.up),
                    static_cast<float>(from.fov_y_deg),
                    static_cast<float>(from.near_m),
                    static_cast<float>(from.far_m)};
}

void evaluate_environment(SceneDescription& description, Scene& scene) {
  EnvironmentDescription& from = description.environment;
  if (from.image) scene.environment.image = std::move(*from.image);
  from.image.reset();
  scene.environment.scale = static_cast<float>(from.scale);
  scene.environment.zenith = glm::vec3(from.zenith);
  scene.environment.horizon = glm::vec3(from.horizon);
  scene.environment.ground = glm::vec3(from.ground);
}

}  // namespace

glm::dmat3 turn(const SceneDescription& scene, const Placement& placement, FilePosition place, double time_s) {
  if (glm::length(placement.rotation_axis) < 1e-9) contradict(scene, place, "rotation_axis must not be zero");
  const glm::dmat3 turned = rotation(placement.rotation_axis, placement.rotation_deg);
  return placement.spin ? placement.spin->at(time_s) * turned : turned;
}

glm::dvec3 position_at(const glm::dvec3& position, const std::optional<MotionPath>& path, double time_s) {
  return path ? path->at(time_s) : position;
}

std::vector<Affected> all_parts(const SceneDescription& description) {
  std::vector<Affected> parts;
  const auto add = [&](Part part, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      parts.push_back({part, i});
  };
  add(Part::mesh, description.meshes.size());
  add(Part::forest, description.forest ? 1 : 0);
  add(Part::material, description.materials.size());
  add(Part::relief_maps, description.reliefs.size());
  add(Part::relief, description.reliefs.size());
  add(Part::instance, description.instances.size());
  add(Part::light, description.lights.size());
  add(Part::view, description.views.size());
  add(Part::voxels, description.volume ? 1 : 0);
  add(Part::scattering, description.volume ? 1 : 0);
  add(Part::transfer, description.volume ? 1 : 0);
  add(Part::medium, description.volume ? 1 : 0);
  add(Part::environment, 1);
  add(Part::ambient, 1);
  return parts;
}

void evaluate(SceneDescription& description, Affected what, double time_s, Scene& scene) {
  switch (what.part) {
    case Part::mesh:
      return evaluate_mesh(description, what.index, scene);
    case Part::forest:
      return evaluate_forest(description, scene);
    case Part::material: {
      const MaterialDescription& from = description.materials[what.index];
      scene.materials[what.index] = {from.name,
                                     glm::vec3(from.albedo),
                                     glm::vec3(from.emission),
                                     from.kind,
                                     glm::vec3(from.reflectance),
                                     glm::vec3(from.metal_n),
                                     glm::vec3(from.metal_k),
                                     static_cast<float>(from.ior),
                                     glm::vec3(from.absorption),
                                     glm::vec3(from.scattering),
                                     static_cast<float>(from.anisotropy)};
      return;
    }
    case Part::relief_maps:
      return evaluate_relief_maps(description, what.index, time_s, scene);
    case Part::relief:
      return evaluate_relief(description, what.index, scene);
    case Part::instance:
      return evaluate_instance(description, what.index, time_s, scene);
    case Part::light:
      return evaluate_light(description, what.index, time_s, scene);
    case Part::view:
      return evaluate_view(description, what.index, time_s, scene);
    case Part::voxels:
      return evaluate_voxels(description, scene);
    case Part::scattering:
      return evaluate_scattering(description, scene);
    case Part::transfer:
      return evaluate_transfer(description, scene);
    case Part::medium:
      return evaluate_medium(description, time_s, scene);
    case Part::environment:
      return evaluate_environment(description, scene);
    case Part::ambient:
      scene.ambient = glm::vec3(description.ambient);
      return;
  }
}

}  // namespace pellucid
