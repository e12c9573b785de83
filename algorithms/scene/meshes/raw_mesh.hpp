#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "gl/error.hpp"

/// Behind load_mesh_file(): what a format's reader hands over, and what the readers share.
namespace pellucid {

/// A mesh as its file states it, before it is rounded to 32 bits.
struct RawMesh {
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec3> normals;  ///< empty, or one per position; of no length where the file states none
  std::vector<glm::vec3> colors;   ///< empty, or one per position, in [0, 1]
  std::vector<glm::vec2> uvs;      ///< empty, or one per position
  std::vector<glm::uvec3> triangles;
  std::vector<std::uint32_t> smoothing;  ///< empty, or one per triangle: bits of the groups within which it is smoothed

  std::vector<std::filesystem::path> files;  ///< read beside the file itself
  std::vector<std::string> warnings;         ///< what was left out, a sentence each
};

/// "cannot read mesh 'path': reason".
InputError unreadable_mesh(const std::filesystem::path&, std::string_view reason);

/// The whole file. Throws when it is missing, empty, or larger than 2 GiB.
std::string mesh_bytes(const std::filesystem::path&);

/// Faces as a file lists them; triangulated when all positions are known.
class Faces {
 public:
  void begin() { begins_.push_back(static_cast<std::uint32_t>(corners_.size())); }
  void corner(std::uint32_t vertex) { corners_.push_back(vertex); }
  std::size_t size() const { return begins_.size(); }
  std::size_t corners() const { return corners_.size(); }
  void reserve(std::size_t faces) {
    begins_.reserve(faces);
    corners_.reserve(3 * faces);
  }
  /// Appends the triangles to the mesh: convex faces as fans, others by cutting off ears (Meisters 1975). Faces of one
  /// or two corners are left out, with a warning. Throws when there are too many, a face has no corners, or is too
  /// large to cut.
  void triangulate(const std::filesystem::path&, RawMesh&) const;

 private:
  std::vector<std::uint32_t> corners_, begins_;
};

/// Colours of a text format, whose range no header states: all in [0, 1], or whole numbers up to 255. Throws when they
/// are neither.
std::vector<glm::vec3> colors_of_text(const std::filesystem::path&, const std::vector<glm::vec3>& stated);

/// Throws unless there may be so many.
void check_mesh_size(const std::filesystem::path&, std::uint64_t vertices, std::uint64_t triangles);

RawMesh read_ply(const std::filesystem::path&);
RawMesh read_off(const std::filesystem::path&);
RawMesh read_obj(const std::filesystem::path&);
RawMesh read_gltf(const std::filesystem::path&, bool binary);
RawMesh read_3ds(const std::filesystem::path&);

}  // namespace pellucid
