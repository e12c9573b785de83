#include "algorithms/scene/meshes/raw_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "algorithms/scene/files/tell.hpp"
#include "algorithms/scene/meshes/mesh_file.hpp"

namespace pellucid {

namespace fs = std::filesystem;

InputError unreadable_mesh(const fs::path& path, std::string_view reason) {
  return InputError(fmt::format("cannot read mesh '{}': {}", path.string(), reason));
}

std::string mesh_bytes(const fs::path& path) {
  constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{1} << 31;
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(path, error);
  if (error) throw unreadable_mesh(path, error.message());
  if (bytes == 0) throw unreadable_mesh(path, "the file is empty");
  if (bytes > kMaxFileBytes)
    throw unreadable_mesh(path, fmt::format("{} bytes; at most {} are read", bytes, kMaxFileBytes));
  std::ifstream file(path, std::ios::binary);
  std::string content(bytes, '\0');
  if (!file.read(content.data(), static_cast<std::streamsize>(bytes))) throw unreadable_mesh(path, "it cannot be read");
  return content;
}

void check_mesh_size(const fs::path& path, std::uint64_t vertices, std::uint64_t triangles) {
  if (triangles > kMaxTriangles || vertices > 3 * kMaxTriangles)
    throw unreadable_mesh(path, fmt::format("{} vertices and {} faces; at most {} triangles are read", vertices,
                                            triangles, kMaxTriangles));
}

std::vector<glm::vec3> colors_of_text(const fs::path& path, const std::vector<glm::vec3>& stated) {
  bool shares = true, bytes = true;
  for (const glm::vec3& c : stated) {
    for (int i = 0; i < 3; ++i) {
      shares = shares && c[i] >= 0 && c[i] <= 1;
      bytes = bytes && c[i] >= 0 && c[i] <= 255 && c[i] == std::floor(c[i]);
    }
  }
  if (shares) return stated;
  if (!bytes)
    throw unreadable_mesh(path, "its vertex colours are neither all in [0, 1] nor all whole numbers up to 255");
  std::vector<glm::vec3> scaled = stated;
  for (glm::vec3& c : scaled)
    c /= 255.0F;
  return scaled;
}

// ---- triangulation ----

namespace {

using Polygon = std::span<const std::uint32_t>;

double cross(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The polygon seen along the axis on which its area is largest, counter-clockwise.
std::vector<glm::dvec2> flattened(const std::vector<glm::dvec3>& positions, Polygon polygon) {
  const glm::dvec3 origin = positions[polygon[0]];
  glm::dvec3 normal(0.0);  // Newell's, twice the area long
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 a = positions[polygon[i]] - origin;
    const glm::dvec3 b = positions[polygon[(i + 1) % polygon.size()]] - origin;
    normal += glm::cross(a, b);
  }
  const glm::dvec3 size = glm::abs(normal);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double sign = normal[axis] < 0 ? -1 : 1;
  std::vector<glm::dvec2> flat;
  flat.reserve(polygon.size());
  for (const std::uint32_t vertex : polygon) {
    const glm::dvec3 p = positions[vertex] - origin;
    flat.emplace_back(sign * p[u], p[v]);
  }
  return flat;
}

class EarCutter {
 public:
  EarCutter(const fs::path& path, std::vector<glm::dvec2> points, Polygon polygon, RawMesh& mesh)
      : path_(path), points_(std::move(points)), polygon_(polygon), mesh_(mesh), ring_(polygon.size()) {
    for (std::size_t i = 0; i < ring_.size(); ++i)
      ring_[i] = i;
  }

  void cut() {
    constexpr std::size_t kMostWork = 200'000'000;  // tests of a point in a triangle: seconds
    while (ring_.size() > 3) {
      std::size_t ear = 0;
      while (ear < ring_.size() && !is_ear(ear))
        ++ear;
      if (work_ > kMostWork) throw unreadable_mesh(path_, fmt::format("a concave face of {} corners", polygon_.size()));
      if (ear == ring_.size()) ear = 0;  // it crosses itself; whatever is cut off is as good
      emit(ear);
      ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    emit(1);
  }

 private:
  std::size_t at(std::size_t i) const { return ring_[i % ring_.size()]; }
  void emit(std::size_t ear) {
    mesh_.triangles.emplace_back(polygon_[at(ear + ring_.size() - 1)], polygon_[at(ear)], polygon_[at(ear + 1)]);
  }
  bool is_ear(std::size_t i) {
    const glm::dvec2 &a = points_[at(i + ring_.size() - 1)], &b = points_[at(i)], &c = points_[at(i + 1)];
    if (!(cross(a, b, c) > 0)) return false;
    for (const std::size_t other : ring_) {
      ++work_;
      const glm::dvec2& p = points_[other];
      if (p == a || p == b || p == c) continue;
      if (cross(a, b, p) >= 0 && cross(b, c, p) >= 0 && cross(c, a, p) >= 0) return false;
    }
    return true;
  }

  const fs::path& path_;
  std::vector<glm::dvec2> points_;
  Polygon polygon_;
  RawMesh& mesh_;
  std::vector<std::size_t> ring_;
  std::size_t work_ = 0;
};

/// Turns the same way at every corner, and only once around.
bool is_convex(const std::vector<glm::dvec2>& points) {
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (cross(points[i], points[(i + 1) % n], points[(i + 2) % n]) < 0) return false;
    if (i > 0 && i + 1 < n && cross(points[0], points[i], points[i + 1]) < 0) return false;
  }
  return true;
}

void add_polygon(const fs::path& path, Polygon polygon, RawMesh& mesh) {
  if (polygon.size() == 3) {
    mesh.triangles.emplace_back(polygon[0], polygon[1], polygon[2]);
    return;
  }
  std::vector<glm::dvec2> points = flattened(mesh.positions, polygon);
  if (is_convex(points)) {
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
      mesh.triangles.emplace_back(polygon[0], polygon[i], polygon[i + 1]);
    return;
  }
  EarCutter(path, std::move(points), polygon, mesh).cut();
}

}  // namespace

void Faces::triangulate(const fs::path& path, RawMesh& mesh) const {
  if (corners_.size() > 3 * kMaxTriangles)
    throw unreadable_mesh(path, fmt::format("more than {} triangles", kMaxTriangles));
  mesh.triangles.reserve(mesh.triangles.size() + begins_.size());
  std::size_t left_out = 0;
  for (std::size_t f = 0; f < begins_.size(); ++f) {
    const std::size_t end = f + 1 < begins_.size() ? begins_[f + 1] : corners_.size();
    const Polygon polygon(corners_.data() + begins_[f], end - begins_[f]);
    if (polygon.empty()) throw unreadable_mesh(path, fmt::format("face {} has no corners", f));
    if (polygon.size() < 3)
      ++left_out;
    else
      add_polygon(path, polygon, mesh);
  }
  if (left_out > 0)
    mesh.warnings.push_back(fmt::format("{} of fewer than three corners {} left out", counted(left_out, "face"),
                                        left_out == 1 ? "is" : "are"));
}

}  // namespace pellucid
