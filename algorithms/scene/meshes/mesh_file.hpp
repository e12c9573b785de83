#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "algorithms/scene/scene.hpp"

namespace pellucid {

inline constexpr std::size_t kMaxTriangles = 50'000'000;

struct MeshFile {
  Mesh mesh;                                 ///< its positions are the file's less `origin`
  glm::dvec3 origin{0.0};                    ///< not 0 where the file lies so far out that 32 bits would cost shape
  std::vector<std::filesystem::path> files;  ///< the file and those it refers to (a glTF's buffers), in order of use
  std::vector<std::string> warnings;         ///< what was left out or made anew, a sentence each
};

/// Reads OBJ, PLY, OFF, glTF or 3DS: all its triangles as one mesh, node transforms applied, materials left aside.
/// Faces without normals get them: within a file's smoothing groups, else smoothed where they meet at less than
/// `crease_deg`. Vertices that no face names are dropped. Throws InputError: missing, empty, malformed, more than
/// kMaxTriangles, or less in the file than it says of itself.
MeshFile load_mesh_file(const std::filesystem::path&, double crease_deg);

/// Gives the mesh normals: at each corner the mean, weighted by area, of the triangles around that point that meet the
/// corner's own at less than `crease_deg`, or with `groups`, bits for each triangle, that share a group with it.
/// Vertices are split where that differs.
void make_normals(Mesh&, double crease_deg, std::span<const std::uint32_t> groups = {});

/// Scales the mesh so that its longest side is `size_m`, and centres its bounds on the origin.
void fit_mesh(Mesh&, double size_m);

/// Puts the mesh back to the file's own place, with a warning where rounding to 32 bits then moves its points by more
/// than a thousandth of its extent.
void restore_origin(MeshFile&);

/// How far rounding to 32 bits may move a point of a box, as a share of its longest side.
double rounding_share(const glm::dvec3& low, const glm::dvec3& high);

}  // namespace pellucid
