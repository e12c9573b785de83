#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "algorithms/geocube/cube_textures.hpp"
#include "algorithms/geocube/geocube.hpp"
#include "algorithms/geocube/solid.hpp"
#include "algorithms/scene/scene.hpp"
#include "gl/objects.hpp"

namespace pellucid::geocube {

struct GlassVertex {
  glm::vec3 position, normal;
  float first_cube;
};
struct GlassMesh {
  std::vector<GlassVertex> vertices;
  std::vector<glm::uvec3> triangles;  ///< in the mesh's order
};
/// The mesh with the cube in which a ray starts that enters at a triangle (Sec. 2.3), told by all of its vertices:
/// those between triangles of different cubes become several. Triangles beyond `first_cubes` start in cube 0.
GlassMesh with_first_cubes(const Mesh&, std::span<const std::uint8_t> first_cubes);

/// An optical object of the scene with what its drawing needs; a dielectric with its cubes. The object's space is the
/// mesh's, or where the instance is scaled unevenly, the world's but for the place: a circular cone must stay one.
class GlassObject {
 public:
  /// Throws InputError as Solid and build_cubes() do, and when cubes are placed by hand but the scene gives none.
  GlassObject(const Scene&, int instance, const Parameters&);

  int instance() const { return instance_; }
  /// True while the instance is a dielectric or none as before, of the same index, scaled as before, and its cubes lie
  /// where they lay if they are placed by hand.
  bool fits(const Scene&, const Parameters&) const;
  glm::mat4 to_world(const Scene&) const;
  void draw() const;

  const Solid* solid() const { return solid_.get(); }  ///< null for a mirror or metal
  const CubeTextures* cubes() const { return cubes_.get(); }
  std::size_t triangle_count() const { return static_cast<std::size_t>(index_count_) / 3; }
  const std::vector<double>& unseen() const { return unseen_; }  ///< of automatic placement, after each cube

 private:
  void place(const Scene&, const Parameters&, const Mesh&, std::vector<glm::dvec3>& centers);

  int instance_ = 0;
  bool dielectric_ = false;
  float ior_ = 0;
  std::optional<glm::mat3> baked_;                 // the linear part that the mesh was transformed by
  std::optional<std::vector<glm::vec3>> by_hand_;  // centres in the mesh's space; none with another placement
  std::unique_ptr<Solid> solid_;
  std::unique_ptr<CubeTextures> cubes_;
  std::vector<double> unseen_;
  gl::Buffer vertices_, indices_;
  gl::VertexArray array_;
  int index_count_ = 0;
};

}  // namespace pellucid::geocube
