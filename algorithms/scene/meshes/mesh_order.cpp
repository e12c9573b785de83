#include "algorithms/scene/meshes/mesh_order.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pellucid {
namespace {

constexpr float kCells = 65535.0F;  // along an axis: three times 16 bits make a key

// The lower 16 bits, two zeros before each.
std::uint64_t spread(std::uint64_t x) {
  std::uint64_t result = 0;
  for (unsigned bit = 0; bit < 16; ++bit)
    result |= (x >> bit & 1U) << (3 * bit);
  return result;
}

std::uint64_t morton_key(const glm::vec3& share) {
  const glm::uvec3 cell(glm::clamp(share, 0.0F, 1.0F) * kCells);
  return spread(cell.x) | spread(cell.y) << 1U | spread(cell.z) << 2U;
}

template <class T>
std::vector<T> picked(const std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  std::vector<T> result;
  if (values.empty()) return result;
  result.reserve(order.size());
  for (const std::uint32_t i : order)
    result.push_back(values[i]);
  return result;
}

}  // namespace

void order_by_place(Mesh& mesh) {
  glm::vec3 low(std::numeric_limits<float>::infinity()), high = -low;
  for (const glm::vec3& p : mesh.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::vec3 extent =
      glm::max(high - low, glm::vec3(std::numeric_limits<float>::min()));  // a plane has none along one

  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
  keys.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& v = mesh.triangles[t];
    const glm::vec3 middle = (mesh.positions[v.x] + mesh.positions[v.y] + mesh.positions[v.z]) / 3.0F;
    keys.emplace_back(morton_key((middle - low) / extent), static_cast<std::uint32_t>(t));
  }
  std::sort(keys.begin(), keys.end());

  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> new_number(mesh.positions.size(), kUnused), old_number;
  old_number.reserve(mesh.positions.size());
  std::vector<glm::uvec3> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& [key, t] : keys) {
    glm::uvec3 triangle = mesh.triangles[t];
    for (int corner = 0; corner < 3; ++corner) {
      std::uint32_t& number = new_number[triangle[corner]];
      if (number == kUnused) {
        number = static_cast<std::uint32_t>(old_number.size());
        old_number.push_back(triangle[corner]);
      }
      triangle[corner] = number;
    }
    triangles.push_back(triangle);
  }
  mesh.triangles = std::move(triangles);
  mesh.positions = picked(mesh.positions, old_number);
  mesh.normals = picked(mesh.normals, old_number);
  mesh.colors = picked(mesh.colors, old_number);
  mesh.uvs = picked(mesh.uvs, old_number);
}

}  // namespace pellucid
