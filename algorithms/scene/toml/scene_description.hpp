#pragma once

#include <cmath>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "algorithms/scene/loading_facts.hpp"
#include "algorithms/scene/motion.hpp"
#include "algorithms/scene/relief/patterns.hpp"
#include "algorithms/scene/scene.hpp"
#include "algorithms/scene/toml/toml_reader.hpp"
#include "algorithms/scene/volumes/volume_file.hpp"

/// The content of a scene file, before it is evaluated at a time and at values of the scene's parameters. Numbers are
/// doubles, integers too, and keep their addresses: parameters write them (DriveTarget).
namespace pellucid {

/// A number of a description that is a count.
inline int whole(double value) {
  return static_cast<int>(std::lround(value));
}

/// Position, turn and motion of an instance or of the volume's box.
struct Placement {
  glm::dvec3 position{0.0};
  std::optional<MotionPath> position_path;  ///< instead of `position`
  glm::dvec3 rotation_axis{0.0, 1.0, 0.0};
  double rotation_deg = 0;
  std::optional<Spin> spin;  ///< after the rotation
};

enum class MeshKind { file, sphere, box, plane, cylinder, cone, torus, star, teapot, relief, tiles };
struct MeshDescription {
  std::string name;
  FilePosition place;
  MeshKind kind = MeshKind::sphere;
  std::optional<Mesh> from_file;  ///< moved into the scene when it is evaluated
  double radius = 1, height = 1, minor_radius = 0.25, scale = 1;
  glm::dvec3 size{1.0};
  glm::dvec2 plane_size{1.0};
  double segments = 32;
  double frequency = 3, octaves = 3, ripples = 0, seed = 1;
  double columns = 8, rows = 8, joint = 0.05, contrast = 0.6, hue = 0.2;
  bool running = false;
  double lobes = 3, amplitude = 0.35;
};

struct MaterialDescription {
  std::string name;
  glm::dvec3 albedo{0.5}, emission{0.0};
  SurfaceKind kind = SurfaceKind::lambertian;
  glm::dvec3 reflectance{1.0}, metal_n{1.0}, metal_k{5.0};
  double ior = 1.5;
  glm::dvec3 absorption{0.0}, scattering{0.0};
  double anisotropy = 0;
};

struct InstanceDescription {
  std::string name;
  FilePosition place;
  int mesh = 0, material = 0;
  Placement placement;
  glm::dvec3 scale{1.0}, tint{1.0};
  std::vector<glm::dvec3> cubes;  ///< never resized once it is read: parameters write the points
  int relief = -1;
};

/// One height field of a relief.
struct ReliefLayerDescription {
  Pattern kind = Pattern::flat;
  double low_m = -0.1, high_m = 0;
  glm::dvec2 texels{256.0};
  double seed = 1, columns = 4, rows = 8, joint = 0.12, frequency = 4, octaves = 4, roughness = 0.15, contrast = 0.4;
  double level = 1, waves = 12, size_m = 1;
  double share = 0.7, radius = 0.5, height_m = 0.01;  ///< of drops
  double drops = 96, fall = 16;                       ///< of rain
  Image heights, normals, colors;                     ///< from files, rows from the bottom; or empty
  glm::dvec3 albedo{0.5};
  double specular = 0, exponent = 50;
};
struct ReliefAirDescription {
  double height_m = 0.1, ground_index = 1.0001, index = 1.0003;
  bool exponential = false;
  double falloff_m = 0.02, turbulence = 0, seed = 1;
  glm::dvec3 texels{32, 32, 64};
};
struct ReliefDescription {
  std::string name;
  FilePosition place;
  glm::dvec2 tiling{1.0};
  bool cut = true;
  ReliefLayerDescription solid;
  std::optional<ReliefLayerDescription> translucent;
  double outside_index = 1, index = 1.33, intensification = 0;
  glm::dvec3 half_depth_m{1e6}, scattering{0.0};
  double anisotropy = 0;
  std::optional<ReliefAirDescription> air;
};

struct LightDescription {
  std::string name;
  FilePosition place;
  LightKind kind = LightKind::directional;
  glm::dvec3 position{0.0};
  std::optional<MotionPath> position_path;
  bool by_angles = false;  ///< the direction is given by where the light comes from
  double azimuth_deg = 0, elevation_deg = 45;
  glm::dvec3 direction{0.0, -1.0, 0.0};
  std::optional<MotionPath> direction_path;  ///< instead of `direction`
  std::optional<Spin> spin;
  glm::dvec3 intensity{1.0};
  double inner_angle_deg = 20, outer_angle_deg = 30;
  bool casts_shadow = false;
  bool animated() const { return position_path || direction_path || spin; }
};

struct ViewDescription {
  std::string name;
  FilePosition place;
  glm::dvec3 eye{0.0}, target{0.0}, up{0.0, 1.0, 0.0};
  std::optional<MotionPath> eye_path, target_path;
  std::optional<Spin> spin;  ///< of the eye about the target
  double fov_y_deg = 45, near_m = 0.1, far_m = 1000;
};

struct ForestDescription {
  FilePosition place;
  glm::dvec2 extent{60.0}, clearing{0.0};
  double trees = 300, clearing_radius = 4, relief_m = 1.5, seed = 1;
};

struct TransferDescription {
  FilePosition place;
  double density = 0, extinction = 0;
  glm::dvec3 albedo{1.0};
};

enum class VolumeKind { constant, fog, ball, smoke, water, file };
struct VolumeDescription {
  std::string name;
  FilePosition place;
  VolumeKind kind = VolumeKind::constant;
  glm::dvec3 voxels{128.0};
  bool by_corners = false;
  glm::dvec3 min{-0.5}, max{0.5};
  Placement placement;  ///< of the box's centre
  glm::dvec3 size{1.0};
  double density = 1, extinction = 1;
  glm::dvec3 albedo{1.0}, emission{0.0};
  std::deque<TransferDescription> transfer;
  int light = -1;  ///< in whose space the box lies: it encloses the cone between `near_m` and `range_m`
  double near_m = 0.05, range_m = 1;
  double seed = 1, octaves = 4, frequency = 3, height_falloff = 3, contrast = 0.7, swirl = 0.5;
  double depth_gradient = 0.3, level = 0.9, wave = 0.01;
  std::optional<Densities> from_file;  ///< its values are moved into the scene when it is evaluated
};

struct EnvironmentDescription {
  std::optional<Image> image;  ///< moved into the scene when it is evaluated
  double scale = 1;
  glm::dvec3 zenith{0.0}, horizon{0.0}, ground{0.0};
};

enum class DriveMode { set, scale, add };
struct ParameterDescription {
  ParameterInfo info;
  FilePosition place;
  DriveMode mode = DriveMode::set;
  std::vector<std::pair<std::string, FilePosition>> drives;
};

/// Deques, so that what parameters write never moves.
struct SceneDescription {
  TomlFile file;
  std::string title, description, stand_in;
  std::deque<MeshDescription> meshes;
  std::deque<MaterialDescription> materials;
  std::deque<ReliefDescription> reliefs;
  std::deque<InstanceDescription> instances;
  std::deque<LightDescription> lights;
  std::deque<ViewDescription> views;
  std::optional<ForestDescription> forest;
  std::optional<VolumeDescription> volume;
  EnvironmentDescription environment;
  glm::dvec3 ambient{0.0};
  std::vector<ParameterDescription> parameters;

  std::vector<DriveTarget> targets;
  std::vector<Affected> animated;                               ///< what changes with time
  std::vector<std::pair<std::string, std::string>> files_read;  ///< name in the scene file, SHA-256
  LoadingFacts facts;

  /// Adds the warning "s.toml:3:8: environment.image: …".
  void warn(const TableReader&, std::string_view key, std::string_view message);

  SceneDescription() = default;
  SceneDescription(const SceneDescription&) = delete;
  SceneDescription& operator=(const SceneDescription&) = delete;
};

/// Fills `scene` from the text of a scene file. Names in it that are no assets are relative to `folder`.
void parse_scene(std::string_view text, const std::filesystem::path& folder, SceneDescription& scene);

// The sections, one function each; called in this order by parse_scene().
void parse_materials(TableReader& root, SceneDescription&);
void parse_meshes(TableReader& root, const std::filesystem::path& folder, SceneDescription&);
void parse_reliefs(TableReader& root, const std::filesystem::path& folder, SceneDescription&);
void parse_instances(TableReader& root, SceneDescription&);
/// Reads the key `relief` of an instance, whose mesh and material are known.
void carry_relief(TableReader&, const SceneDescription&, InstanceDescription&);
void parse_forest(TableReader& root, SceneDescription&);
void parse_lights(TableReader& root, SceneDescription&);
void parse_volume(TableReader& root, const std::filesystem::path& folder, SceneDescription&);
void parse_environment(TableReader& root, const std::filesystem::path& folder, SceneDescription&);
void parse_views(TableReader& root, SceneDescription&);
void parse_parameters(TableReader& root, SceneDescription&);

// Shared by the sections.
std::optional<MotionPath> parse_path(TableReader&, std::string_view key);
std::optional<Spin> parse_spin(TableReader&);
/// Reads `key`, or `key`_path in its place; one of them when required.
void parse_position(TableReader&, const std::string& key, glm::dvec3& position, std::optional<MotionPath>& path, Need);
/// Finds the file that `key` names and records its content. The mesh or image itself is read by the caller.
std::filesystem::path parse_file_name(TableReader&, std::string_view key, const std::filesystem::path& folder,
                                      SceneDescription&);
/// Throws what `work` throws as an error at `key`.
template <class Work>
auto located(const TableReader& reader, std::string_view key, Work&& work) {
  try {
    return work();
  } catch (const InputError& error) {
    reader.fail(reader.place(key), error.what());
  }
}

[[noreturn]] void fail_unknown(const TableReader&, std::string_view key, const std::string& name,
                               const std::vector<std::string>& known, std::string_view kind);
/// The position of `key`'s text among `things`, by name.
template <class Things>
int find_named(TableReader& reader, std::string_view key, const Things& things, std::string_view kind) {
  std::string name;
  reader.text(key, name, Need::required);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < things.size(); ++i) {
    if (things[i].name == name) return static_cast<int>(i);
    names.push_back(things[i].name);
  }
  fail_unknown(reader, key, name, names, kind);
}
/// Evaluates one part at a time of the scene. Throws InputError at the part's place when its numbers contradict each
/// other (near_m ≥ far_m).
void evaluate(SceneDescription&, Affected, double time_s, Scene&);
void evaluate_voxels(SceneDescription&, Scene&);
/// The images and heights of a relief; and all else of it.
void evaluate_relief_maps(const SceneDescription&, std::size_t index, double time_s, Scene&);
void evaluate_relief(const SceneDescription&, std::size_t index, Scene&);
/// The scattering at the voxels of a volume in a light's space; its box is left alone.
void evaluate_scattering(const SceneDescription&, Scene&);
void evaluate_transfer(const SceneDescription&, Scene&);
void evaluate_medium(const SceneDescription&, double time_s, Scene&);
/// Shared by instances and the volume.
glm::dmat3 turn(const SceneDescription&, const Placement&, FilePosition, double time_s);
glm::dvec3 position_at(const glm::dvec3& position, const std::optional<MotionPath>&, double time_s);
/// Every part, in order.
std::vector<Affected> all_parts(const SceneDescription&);

}  // namespace pellucid
