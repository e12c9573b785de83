#include "algorithms/scene/meshes/mesh_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <new>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "algorithms/scene/meshes/raw_mesh.hpp"

namespace pellucid {

namespace fs = std::filesystem;

namespace {

constexpr double kMaxRoundingShare = 1e-3;

struct Box {
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
  template <class Positions>
  explicit Box(const Positions& positions) {
    for (const auto& p : positions) {
      low = glm::min(low, glm::dvec3(p));
      high = glm::max(high, glm::dvec3(p));
    }
  }
  double longest() const {
    const glm::dvec3 sides = high - low;
    return std::max({sides.x, sides.y, sides.z});
  }
};

RawMesh read_raw(const fs::path& path) {
  const std::string shown = path.extension().string();
  std::string kind = shown;
  std::transform(kind.begin(), kind.end(), kind.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (kind == ".obj") return read_obj(path);
  if (kind == ".ply") return read_ply(path);
  if (kind == ".off") return read_off(path);
  if (kind == ".gltf" || kind == ".glb") return read_gltf(path, kind == ".glb");
  if (kind == ".3ds") return read_3ds(path);
  throw unreadable_mesh(path, fmt::format("'{}' is not one of .obj, .ply, .off, .gltf, .glb, .3ds", shown));
}

template <class T>
void keep(std::vector<T>& values, const std::vector<std::uint32_t>& old_numbers) {
  if (values.empty()) return;
  std::vector<T> kept;
  kept.reserve(old_numbers.size());
  for (const std::uint32_t old : old_numbers)
    kept.push_back(values[old]);
  values = std::move(kept);
}

/// Scanners leave points without a place, and any vertex without a face would count for the bounds.
void drop_unused_vertices(RawMesh& raw) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> numbers(raw.positions.size(), kUnused), old_numbers;
  for (const glm::uvec3& t : raw.triangles)
    for (int c = 0; c < 3; ++c)
      numbers[t[c]] = 0;
  for (std::uint32_t v = 0; v < numbers.size(); ++v) {
    if (numbers[v] == kUnused) continue;
    numbers[v] = static_cast<std::uint32_t>(old_numbers.size());
    old_numbers.push_back(v);
  }
  if (old_numbers.size() == raw.positions.size()) return;
  for (glm::uvec3& t : raw.triangles)
    t = {numbers[t.x], numbers[t.y], numbers[t.z]};
  keep(raw.positions, old_numbers);
  keep(raw.normals, old_numbers);
  keep(raw.colors, old_numbers);
  keep(raw.uvs, old_numbers);
}

/// Shifts before rounding, where the mesh lies far from the origin.
void round_positions(const fs::path& path, const RawMesh& raw, MeshFile& file) {
  for (std::size_t v = 0; v < raw.positions.size(); ++v) {
    const glm::dvec3& p = raw.positions[v];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw unreadable_mesh(path, fmt::format("vertex {} is not finite", v));
  }
  const Box box(raw.positions);
  constexpr double kFar = 16;  // extents
  const glm::dvec3 reach = glm::max(glm::abs(box.low), glm::abs(box.high));
  if (std::max({reach.x, reach.y, reach.z}) > kFar * box.longest()) file.origin = box.low + (box.high - box.low) / 2.0;
  file.mesh.positions.reserve(raw.positions.size());
  for (const glm::dvec3& p : raw.positions) {
    const glm::vec3 rounded(p - file.origin);
    if (!std::isfinite(rounded.x) || !std::isfinite(rounded.y) || !std::isfinite(rounded.z))
      throw unreadable_mesh(path, "its coordinates are too large for 32 bits");
    file.mesh.positions.push_back(rounded);
  }
}

bool has_direction(const glm::vec3& normal) {
  const double length = glm::length(glm::dvec3(normal));
  return std::isfinite(length) && length > 0;
}

/// The file's normals where it has them; what a triangle lacks at any corner is made for all three.
void set_normals(RawMesh& raw, double crease_deg, MeshFile& file) {
  Mesh& mesh = file.mesh;
  const bool grouped = std::any_of(raw.smoothing.begin(), raw.smoothing.end(), [](std::uint32_t g) { return g != 0; });
  const std::span<const std::uint32_t> groups(raw.smoothing.data(), grouped ? raw.smoothing.size() : 0);
  if (raw.normals.empty()) {
    make_normals(mesh, crease_deg, groups);
    return;
  }
  const auto lacks = [&](const glm::uvec3& t) {
    return !has_direction(raw.normals[t.x]) || !has_direction(raw.normals[t.y]) || !has_direction(raw.normals[t.z]);
  };
  const auto lacking = std::count_if(mesh.triangles.begin(), mesh.triangles.end(), lacks);
  Mesh made;
  if (lacking > 0) {
    made.positions = mesh.positions;
    made.triangles = mesh.triangles;
    make_normals(made, crease_deg, groups);
    file.warnings.push_back(
        fmt::format("{} of its {} triangles have no normals; they are made", lacking, mesh.triangles.size()));
  }
  for (const glm::vec3& n : raw.normals)
    mesh.normals.push_back(has_direction(n) ? glm::vec3(glm::normalize(glm::dvec3(n))) : glm::vec3(0, 1, 0));
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> split;  // given and made vertex to a new one
  for (std::size_t f = 0; lacking > 0 && f < mesh.triangles.size(); ++f) {
    glm::uvec3& t = mesh.triangles[f];
    if (!lacks(t)) continue;
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t given = t[c], other = made.triangles[f][c];
      const auto [at, is_new] =
          split.emplace(std::pair(given, other), static_cast<std::uint32_t>(mesh.positions.size()));
      t[c] = at->second;
      if (!is_new) continue;
      mesh.positions.push_back(glm::vec3(mesh.positions[given]));
      mesh.normals.push_back(made.normals[other]);
      raw.normals.push_back(made.normals[other]);
      if (!mesh.colors.empty()) mesh.colors.push_back(glm::vec3(mesh.colors[given]));
      if (!mesh.uvs.empty()) mesh.uvs.push_back(glm::vec2(mesh.uvs[given]));
    }
  }
}

}  // namespace

MeshFile load_mesh_file(const fs::path& path, double crease_deg) {
  try {
    RawMesh raw = read_raw(path);
    if (raw.triangles.empty()) throw unreadable_mesh(path, "it has no triangles");
    check_mesh_size(path, raw.positions.size(), raw.triangles.size());
    drop_unused_vertices(raw);
    MeshFile file;
    file.files = {path};
    file.files.insert(file.files.end(), raw.files.begin(), raw.files.end());
    file.warnings = std::move(raw.warnings);
    round_positions(path, raw, file);
    file.mesh.colors = std::move(raw.colors);
    file.mesh.uvs = std::move(raw.uvs);
    file.mesh.triangles = std::move(raw.triangles);
    set_normals(raw, crease_deg, file);
    return file;
  } catch (const std::bad_alloc&) {
    throw unreadable_mesh(path, "not enough memory");
  }
}

void fit_mesh(Mesh& mesh, double size_m) {
  const Box box(mesh.positions);
  if (!(box.longest() > 0)) throw InputError("all its vertices are one point");
  const glm::dvec3 center = (box.low + box.high) / 2.0;
  for (glm::vec3& p : mesh.positions)
    p = glm::vec3((glm::dvec3(p) - center) * (size_m / box.longest()));
}

double rounding_share(const glm::dvec3& low, const glm::dvec3& high) {
  const glm::dvec3 sides = high - low, reach = glm::max(glm::abs(low), glm::abs(high));
  const double longest = std::max({sides.x, sides.y, sides.z});
  constexpr double kHalfStep = 1.0 / (1 << 24);
  return longest > 0 ? std::max({reach.x, reach.y, reach.z}) * kHalfStep / longest : 0;
}

void restore_origin(MeshFile& file) {
  if (file.origin == glm::dvec3(0.0)) return;
  const Box box(file.mesh.positions);
  const double share = rounding_share(box.low + file.origin, box.high + file.origin);
  if (share > kMaxRoundingShare)
    file.warnings.push_back(
        fmt::format("it lies so far from the origin that 32 bits move its points by up to {:.2g} of its extent; "
                    "fit_m centres it before it is rounded",
                    share));
  for (glm::vec3& p : file.mesh.positions)
    p = glm::vec3(glm::dvec3(p) + file.origin);
  file.origin = glm::dvec3(0.0);
}

}  // namespace pellucid
