#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "algorithms/scene/scene.hpp"

namespace pellucid {

inline constexpr std::size_t kMaxTriangles = 50'000'000;

struct MeshFile {
  Mesh mesh;
  std::vector<std::filesystem::path> files;  ///< the file and those it refers to (a glTF's buffers), in order of use
};

/// Reads OBJ, PLY, OFF, glTF or 3DS: all its triangles as one mesh, node transforms applied, materials left aside. A
/// file without normals gets them, smoothed where faces meet at less than `crease_deg`. Throws InputError: missing,
/// empty, malformed, or more than kMaxTriangles.
MeshFile load_mesh_file(const std::filesystem::path&, double crease_deg);

/// Gives the mesh normals: at each corner the mean, weighted by area, of the triangles around that point that meet the
/// corner's own at less than `crease_deg`. Vertices are split where that differs.
void make_normals(Mesh&, double crease_deg);

/// Scales the mesh so that its longest side is `size_m`, and centres its bounds on the origin.
void fit_mesh(Mesh&, double size_m);

}  // namespace pellucid
