#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "algorithms/scattering/slab.hpp"
#include "algorithms/scene/files/hash.hpp"
#include "algorithms/scene/meshes/mesh_file.hpp"
#include "algorithms/scene/meshes/mesh_order.hpp"
#include "algorithms/scene/meshes/mesh_processing.hpp"
#include "algorithms/scene/toml/scene_description.hpp"

/// Materials, meshes, instances and the forest.
namespace pellucid {

namespace {

constexpr NumberRange kSegments{3, 2048};
constexpr NumberRange kAnisotropy{-scattering::kMaxAnisotropy, scattering::kMaxAnisotropy};
constexpr NumberRange kMetalIndex{0.01, 20};
constexpr NumberRange kExtinctionIndex{0, 50};
constexpr std::size_t kMostCubes = 16;  // of an object; what geocube's `cubes` goes up to

void parse_file_mesh(TableReader& reader, const std::filesystem::path& folder, MeshDescription& mesh,
                     SceneDescription& scene) {
  reader.set_affected(std::nullopt);
  double crease_deg = 60;
  double fit_m = 0;
  reader.number("crease_deg", crease_deg, {0, 180});
  reader.number("fit_m", fit_m, kLength);
  MeshProcessing processing;
  double subdivide = 0;
  reader.boolean("close_holes", processing.close_holes);
  reader.integer("subdivide", subdivide, {0, 5});
  processing.subdivide = static_cast<int>(subdivide);
  const std::filesystem::path path = parse_file_name(reader, "file", folder, scene);
  // The file that this refers to counts as well.
  const auto note_files = [&](const std::vector<std::filesystem::path>& files) {
    for (const std::filesystem::path& other : files) {
      if (other == path) continue;
      scene.files_read.emplace_back(other.filename().string(), sha256_file(other));
      scene.facts.files.push_back(other);
    }
  };
  MeshFile file;
  if (reader.has("isosurface")) {
    IsosurfaceOptions options;
    reader.number("isosurface", options.level, {-1e30, 1e30});
    reader.number("refine", options.refine, {1, 4});
    const VolumeFile volume = located(reader, "file", [&] { return load_volume_file(path); });
    note_files(volume.files);
    file.mesh = located(reader, "isosurface", [&] { return isosurface(volume, options); });
    if (reader.has("crease_deg")) make_normals(file.mesh, crease_deg);
  } else {
    file = located(reader, "file", [&] { return load_mesh_file(path, crease_deg); });
    note_files(file.files);
  }
  located(reader, "file", [&] {
    process_mesh(file.mesh, processing, crease_deg);
    if (fit_m > 0) {
      fit_mesh(file.mesh, fit_m);
    } else {
      restore_origin(file);
    }
  });
  for (const std::string& warning : file.warnings)
    scene.warn(reader, "file", warning);
  order_by_place(file.mesh);
  mesh.from_file = std::move(file.mesh);
}

void parse_shape(TableReader& reader, MeshDescription& mesh) {
  reader.require("shape");
  static constexpr MeshKind kKinds[] = {MeshKind::sphere, MeshKind::box,   MeshKind::plane, MeshKind::cylinder,
                                        MeshKind::cone,   MeshKind::torus, MeshKind::star,  MeshKind::teapot,
                                        MeshKind::relief, MeshKind::tiles};
  mesh.kind = kKinds[reader.choice(
      "shape", {"sphere", "box", "plane", "cylinder", "cone", "torus", "star", "teapot", "relief", "tiles"}, 0)];
  switch (mesh.kind) {
    case MeshKind::sphere:
      reader.number("radius", mesh.radius, kLength);
      reader.integer("segments", mesh.segments, kSegments);
      break;
    case MeshKind::box:
      reader.extent("size", mesh.size, kLength, false);
      break;
    case MeshKind::plane:
      mesh.segments = 1;
      reader.vector("size", mesh.plane_size, kLength);
      reader.integer("segments", mesh.segments, {1, kSegments.max});
      break;
    case MeshKind::cylinder:
    case MeshKind::cone:
      reader.number("radius", mesh.radius, kLength);
      reader.number("height", mesh.height, kLength);
      reader.integer("segments", mesh.segments, kSegments);
      break;
    case MeshKind::torus:
      reader.number("radius", mesh.radius, kLength);
      reader.number("minor_radius", mesh.minor_radius, kLength);
      reader.integer("segments", mesh.segments, kSegments);
      break;
    case MeshKind::star:
      mesh.segments = 96;
      reader.number("radius", mesh.radius, kLength);
      reader.integer("lobes", mesh.lobes, {1, 64});
      reader.number("amplitude", mesh.amplitude, {0, 0.9});
      reader.integer("segments", mesh.segments, kSegments);
      break;
    case MeshKind::teapot:
      mesh.segments = 8;
      reader.number("scale", mesh.scale, kLength);
      reader.integer("subdivisions", mesh.segments, {1, 256});
      break;
    case MeshKind::relief:
      mesh.segments = 64;
      mesh.height = 0.1;
      reader.vector("size", mesh.plane_size, kLength);
      reader.integer("segments", mesh.segments, {1, 1024});
      reader.number("height", mesh.height, {0, 1e6});
      reader.number("frequency", mesh.frequency, {0, 1000});
      reader.integer("octaves", mesh.octaves, {1, 12});
      reader.number("ripples", mesh.ripples, kShare);
      reader.integer("seed", mesh.seed, {0, 4294967295.0});
      break;
    case MeshKind::tiles:
      reader.vector("size", mesh.plane_size, kLength);
      reader.integer("columns", mesh.columns, {1, 256});
      reader.integer("rows", mesh.rows, {1, 256});
      reader.number("joint", mesh.joint, {0, 0.9});
      mesh.running = reader.choice("bond", {"stack", "running"}, 0) == 1;
      reader.number("contrast", mesh.contrast, kShare);
      reader.number("hue", mesh.hue, kShare);
      reader.integer("seed", mesh.seed, {0, 4294967295.0});
      break;
    case MeshKind::file:
      break;
  }
}

}  // namespace

void fail_unknown(const TableReader& reader, std::string_view key, const std::string& name,
                  const std::vector<std::string>& known, std::string_view kind) {
  const std::string near = nearest_name(name, known);
  reader.fail(key, fmt::format("there is no {} '{}'{}", kind, name,
                               !near.empty()   ? fmt::format("; did you mean '{}'?", near)
                               : known.empty() ? ""
                                               : fmt::format("; there are {}", fmt::join(known, ", "))));
}

void parse_materials(TableReader& root, SceneDescription& scene) {
  for (auto& [name, reader] : root.named_tables("materials")) {
    reader.set_affected(Affected{Part::material, scene.materials.size()});
    MaterialDescription& material = scene.materials.emplace_back();
    material.name = name;
    static constexpr SurfaceKind kKinds[] = {SurfaceKind::lambertian, SurfaceKind::mirror, SurfaceKind::metal,
                                             SurfaceKind::dielectric};
    material.kind = kKinds[reader.choice("kind", {"lambertian", "mirror", "metal", "dielectric"}, 0)];
    switch (material.kind) {
      case SurfaceKind::lambertian:
        reader.color("albedo", material.albedo, kShare);
        reader.color("emission", material.emission, kRadiance);
        break;
      case SurfaceKind::mirror:
        reader.color("reflectance", material.reflectance, kShare);
        break;
      case SurfaceKind::metal:
        reader.color("reflectance", material.reflectance, kShare);
        reader.color("n", material.metal_n, kMetalIndex, Need::required);
        reader.color("k", material.metal_k, kExtinctionIndex, Need::required);
        break;
      case SurfaceKind::dielectric:
        reader.number("ior", material.ior, kRefractiveIndex);
        reader.color("absorption", material.absorption, kRadiance);
        reader.color("scattering", material.scattering, kRadiance);
        reader.number("anisotropy", material.anisotropy, kAnisotropy);
        break;
    }
    reader.finish();
  }
}

void parse_meshes(TableReader& root, const std::filesystem::path& folder, SceneDescription& scene) {
  for (auto& [name, reader] : root.named_tables("meshes")) {
    reader.set_affected(Affected{Part::mesh, scene.meshes.size()});
    MeshDescription& mesh = scene.meshes.emplace_back();
    mesh.name = name;
    mesh.place = reader.place();
    reader.exclude("shape", "file");
    if (reader.has("file")) {
      mesh.kind = MeshKind::file;
      parse_file_mesh(reader, folder, mesh, scene);
    } else {
      parse_shape(reader, mesh);
    }
    reader.finish();
  }
}

void parse_instances(TableReader& root, SceneDescription& scene) {
  for (auto& [name, reader] : root.named_tables("instances")) {
    const Affected affected{Part::instance, scene.instances.size()};
    reader.set_affected(affected);
    InstanceDescription& instance = scene.instances.emplace_back();
    instance.name = name;
    instance.place = reader.place();
    instance.mesh = find_named(reader, "mesh", scene.meshes, "mesh");
    instance.material = find_named(reader, "material", scene.materials, "material");
    parse_position(reader, "position", instance.placement.position, instance.placement.position_path, Need::optional);
    reader.vector("rotation_axis", instance.placement.rotation_axis, kCoordinate);
    reader.number("rotation_deg", instance.placement.rotation_deg, kAngleDeg);
    instance.placement.spin = parse_spin(reader);
    reader.extent("scale", instance.scale, kLength, false);
    reader.color("tint", instance.tint, kShare);
    reader.points("cubes", instance.cubes, kCoordinate, kMostCubes);
    if (reader.has("relief")) carry_relief(reader, scene, instance);
    reader.finish();
    if (instance.placement.position_path || instance.placement.spin) scene.animated.push_back(affected);
  }
}

void parse_forest(TableReader& root, SceneDescription& scene) {
  std::optional<TableReader> reader = root.table("forest");
  if (!reader) return;
  reader->set_affected(Affected{Part::forest, 0});
  ForestDescription& forest = scene.forest.emplace();
  forest.place = reader->place();
  reader->vector("extent", forest.extent, {1, 1e4});
  reader->integer("trees", forest.trees, {0, 100000});
  reader->vector("clearing", forest.clearing, kCoordinate);
  reader->number("clearing_radius", forest.clearing_radius, {0, 1e4});
  reader->number("relief_m", forest.relief_m, {0, 100});
  reader->integer("seed", forest.seed, {0, 4294967295.0});
  reader->finish();
}

}  // namespace pellucid
