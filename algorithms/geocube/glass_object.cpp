#include "algorithms/geocube/glass_object.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "algorithms/geocube/cache.hpp"
#include "algorithms/geocube/placement.hpp"
#include "algorithms/scene/files/cache_file.hpp"
#include "gl/error.hpp"

namespace pellucid::geocube {
namespace {

glm::mat3 linear_part(const Scene& scene, int instance) {
  return glm::mat3(scene.instances[static_cast<std::size_t>(instance)].to_world);
}

// A rotation or reflection times one scale.
bool even(const glm::mat3& m) {
  const glm::mat3 square = glm::transpose(m) * m;
  const float mean = (square[0][0] + square[1][1] + square[2][2]) / 3.0F;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (std::abs(square[i][j] - (i == j ? mean : 0.0F)) > 1e-4F * mean) return false;
    }
  }
  return true;
}

Mesh transformed(const Mesh& mesh, const glm::mat3& linear) {
  Mesh result = mesh;
  const glm::mat3 for_normals = glm::transpose(glm::inverse(linear));
  for (glm::vec3& p : result.positions)
    p = linear * p;
  for (glm::vec3& n : result.normals)
    n = glm::normalize(for_normals * n);
  if (glm::determinant(linear) < 0) {
    for (glm::uvec3& t : result.triangles)
      std::swap(t.y, t.z);
  }
  return result;
}

CubeOptions options_of(const Parameters& p, float ior) {
  CubeOptions options;
  options.resolution = p.resolution;
  options.layers = p.layers;
  options.epsilon = static_cast<double>(p.epsilon);
  options.cone_b = p.cone_b;
  options.use_a = p.cones == Cones::a || p.cones == Cones::ab || p.cones == Cones::ac || p.cones == Cones::abc;
  options.use_b = p.cones == Cones::b || p.cones == Cones::ab || p.cones == Cones::bc || p.cones == Cones::abc;
  options.use_c = p.cones == Cones::c || p.cones == Cones::ac || p.cones == Cones::bc || p.cones == Cones::abc;
  options.use_d = p.sphere;
  options.ior = static_cast<double>(ior);
  return options;
}

std::vector<glm::vec3> hand_cubes(const Scene& scene, int instance, const Parameters& p) {
  std::vector<glm::vec3> cubes = scene.instances[static_cast<std::size_t>(instance)].cubes;
  cubes.resize(std::min(cubes.size(), static_cast<std::size_t>(p.cubes)));
  return cubes;
}

}  // namespace

GlassMesh with_first_cubes(const Mesh& mesh, std::span<const std::uint8_t> first_cubes) {
  constexpr int kNone = -1;
  GlassMesh result;
  result.triangles = mesh.triangles;
  std::vector<int> cube_of(mesh.positions.size(), kNone);
  result.vertices.resize(mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    result.vertices[i] = {mesh.positions[i], mesh.normals[i], 0};
  std::map<std::pair<std::uint32_t, int>, std::uint32_t> twins;  // of a vertex, for a further cube
  for (std::size_t t = 0; t < result.triangles.size(); ++t) {
    const int cube = t < first_cubes.size() ? first_cubes[t] : 0;
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t vertex = result.triangles[t][c];
      if (cube_of[vertex] == kNone) {
        cube_of[vertex] = cube;
        result.vertices[vertex].first_cube = static_cast<float>(cube);
      }
      if (cube_of[vertex] == cube) continue;
      const auto [twin, added] = twins.try_emplace({vertex, cube}, static_cast<std::uint32_t>(result.vertices.size()));
      if (added) {
        result.vertices.push_back(result.vertices[vertex]);
        result.vertices.back().first_cube = static_cast<float>(cube);
      }
      result.triangles[t][c] = twin->second;
    }
  }
  return result;
}

GlassObject::GlassObject(const Scene& scene, int instance, const Parameters& parameters) : instance_(instance) {
  const Instance& placed = scene.instances[static_cast<std::size_t>(instance)];
  const Material& material = material_of(scene, instance);
  const Mesh* mesh = &scene.meshes[static_cast<std::size_t>(placed.mesh)];
  dielectric_ = material.kind == SurfaceKind::dielectric;
  ior_ = material.ior;
  Mesh changed;
  const glm::mat3 linear = linear_part(scene, instance);
  if (!even(linear)) {
    baked_ = linear;
    changed = transformed(*mesh, linear);
    mesh = &changed;
  }
  GlassMesh drawn;
  if (dielectric_) {
    solid_ = std::make_unique<Solid>(*mesh, parameters.holes);
    std::vector<glm::dvec3> centers;
    place(scene, parameters, *mesh, centers);
    const CubeSet set = cached_cubes(*solid_, *mesh, centers, options_of(parameters, ior_), cache_folder("geocube"));
    cubes_ = std::make_unique<CubeTextures>(mesh->name, set);
    drawn = with_first_cubes(*mesh, set.first_cube);
  } else {
    drawn = with_first_cubes(*mesh, {});
  }
  vertices_ = gl::Buffer(mesh->name, std::span<const GlassVertex>(drawn.vertices));
  indices_ = gl::Buffer(mesh->name + " indices", std::span<const glm::uvec3>(drawn.triangles));
  array_ = gl::VertexArray(mesh->name, vertices_, sizeof(GlassVertex),
                           {{0, 3, offsetof(GlassVertex, position)},
                            {1, 3, offsetof(GlassVertex, normal)},
                            {2, 1, offsetof(GlassVertex, first_cube)}},
                           &indices_);
  index_count_ = static_cast<int>(drawn.triangles.size() * 3);
}

void GlassObject::place(const Scene& scene, const Parameters& p, const Mesh& mesh, std::vector<glm::dvec3>& centers) {
  switch (p.placement) {
    case Placing::automatic: {
      Placement placement = cached_placement(*solid_, mesh, {.cubes = p.cubes}, cache_folder("geocube"));
      centers = std::move(placement.centers);
      unseen_ = std::move(placement.unseen);
      break;
    }
    case Placing::middle:
      centers = {0.5 * (solid_->low() + solid_->high())};
      break;
    case Placing::hand: {
      by_hand_ = hand_cubes(scene, instance_, p);
      if (by_hand_->empty()) {
        const std::string& name = scene.instances[static_cast<std::size_t>(instance_)].name;
        throw InputError(
            fmt::format("geocube: placement = hand, but instance '{0}' has no cubes; the scene file gives them as "
                        "cubes = [[x, y, z], …] in [instances.{0}]",
                        name));
      }
      for (const glm::vec3& c : *by_hand_)
        centers.emplace_back(baked_ ? *baked_ * c : c);
      break;
    }
  }
}

bool GlassObject::fits(const Scene& scene, const Parameters& parameters) const {
  const Material& material = material_of(scene, instance_);
  if ((material.kind == SurfaceKind::dielectric) != dielectric_) return false;
  if (dielectric_ && material.ior != ior_) return false;
  if (by_hand_ && hand_cubes(scene, instance_, parameters) != *by_hand_) return false;
  const glm::mat3 linear = linear_part(scene, instance_);
  return baked_ ? *baked_ == linear : even(linear);
}

glm::mat4 GlassObject::to_world(const Scene& scene) const {
  const glm::mat4& whole = scene.instances[static_cast<std::size_t>(instance_)].to_world;
  if (!baked_) return whole;
  glm::mat4 place(1.0F);
  place[3] = whole[3];
  return place;
}

void GlassObject::draw() const {
  array_.bind();
  glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace pellucid::geocube
