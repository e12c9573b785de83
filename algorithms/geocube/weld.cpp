#include "algorithms/geocube/weld.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

namespace pellucid::geocube {
namespace {

bool before(const glm::vec3& a, const glm::vec3& b) {
  return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

// For each position the first of those at exactly its place.
std::vector<std::uint32_t> exact_places(const std::vector<glm::vec3>& positions) {
  std::vector<std::uint32_t> order(positions.size()), place(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (before(positions[a], positions[b])) return true;
    return !before(positions[b], positions[a]) && a < b;
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && positions[order[i]] == positions[order[i - 1]];
    place[order[i]] = same ? place[order[i - 1]] : order[i];
  }
  return place;
}

struct CellHash {
  std::size_t operator()(const glm::i64vec3& c) const {
    return static_cast<std::size_t>(c.x * 73856093) ^ static_cast<std::size_t>(c.y * 19349663) ^
           static_cast<std::size_t>(c.z * 83492791);
  }
};

// Joins places nearer than the tolerance, by a grid of cells of that size.
void join_near(const std::vector<glm::vec3>& positions, double tolerance, std::vector<std::uint32_t>& place) {
  std::unordered_map<glm::i64vec3, std::vector<std::uint32_t>, CellHash> cells;
  cells.reserve(positions.size());
  std::vector<std::uint32_t> joined(positions.size());
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    joined[i] = i;
    if (place[i] != i) continue;
    const glm::dvec3 p(positions[i]);
    const glm::i64vec3 cell(glm::floor(p / tolerance));
    std::uint32_t found = i;
    for (int k = 0; k < 27 && found == i; ++k) {
      const auto near = cells.find(cell + glm::i64vec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
      if (near == cells.end()) continue;
      for (const std::uint32_t j : near->second) {
        if (glm::distance(glm::dvec3(positions[j]), p) <= tolerance) {
          found = j;
          break;
        }
      }
    }
    joined[i] = found;
    if (found == i) cells[cell].push_back(i);
  }
  for (std::uint32_t& p : place)
    p = joined[p];
}

struct Edge {
  std::uint64_t key = 0;  ///< smaller corner above, larger below
  std::uint32_t from = 0;
};

}  // namespace

std::string place(const glm::dvec3& p) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", p.x, p.y, p.z);
}

Welded weld(const Mesh& mesh, double tolerance) {
  std::vector<std::uint32_t> at = exact_places(mesh.positions);
  if (tolerance > 0) join_near(mesh.positions, tolerance, at);
  Welded result;
  std::vector<std::uint32_t> number(mesh.positions.size(), ~0U);
  result.triangles.reserve(mesh.triangles.size());
  result.sources.reserve(mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3& t = mesh.triangles[i];
    const glm::uvec3 corners(at[t.x], at[t.y], at[t.z]);
    if (corners.x == corners.y || corners.y == corners.z || corners.z == corners.x) continue;
    glm::uvec3 welded(0);
    for (int c = 0; c < 3; ++c) {
      std::uint32_t& n = number[corners[c]];
      if (n == ~0U) {
        n = static_cast<std::uint32_t>(result.positions.size());
        result.positions.emplace_back(mesh.positions[corners[c]]);
      }
      welded[c] = n;
    }
    result.triangles.push_back(welded);
    result.sources.push_back(i);
  }
  return result;
}

Topology topology(const Welded& surface) {
  std::vector<Edge> edges;
  edges.reserve(3 * surface.triangles.size());
  for (const glm::uvec3& t : surface.triangles) {
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t a = t[c], b = t[(c + 1) % 3];
      edges.push_back({(std::uint64_t{std::min(a, b)} << 32U) | std::max(a, b), a});
    }
  }
  std::sort(edges.begin(), edges.end(),
            [](const Edge& a, const Edge& b) { return a.key != b.key ? a.key < b.key : a.from < b.from; });

  Topology result;
  std::unordered_map<std::uint32_t, std::uint32_t> next;  // of the caps, so against the faces' own sense
  const auto fault = [&](const Edge& edge, const char* what) {
    const glm::dvec3 middle = 0.5 * (surface.positions[edge.key >> 32U] + surface.positions[edge.key & 0xffffffffU]);
    if (result.fault.empty()) result.fault = fmt::format("the edge near {} {}", place(middle), what);
  };
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].key == edges[i].key)
      ++end;
    const Edge& e = edges[i];
    if (end - i == 1) {
      ++result.open_edges;
      const auto low = static_cast<std::uint32_t>(e.key >> 32U), high = static_cast<std::uint32_t>(e.key & 0xffffffffU);
      const std::uint32_t to = e.from == low ? high : low;
      if (!next.emplace(to, e.from).second) fault(e, "is where two holes touch");
    } else if (end - i > 2) {
      fault(e, "has more than two faces");
    } else if (edges[i].from == edges[i + 1].from) {
      fault(e, "has faces that disagree about which side is outside");
    }
    i = end;
  }
  while (!next.empty()) {
    const std::uint32_t start = std::min_element(next.begin(), next.end())->first;
    Border border;
    std::uint32_t at = start;
    for (auto found = next.find(at); found != next.end(); found = next.find(at)) {
      border.push_back(at);
      at = found->second;
      next.erase(found);
    }
    if (at != start && result.fault.empty())
      result.fault = fmt::format("the border near {} does not close", place(surface.positions[at]));
    result.borders.push_back(std::move(border));
  }
  return result;
}

void cap(Welded& surface, const Border& border) {
  glm::dvec3 middle(0.0);
  for (const std::uint32_t corner : border)
    middle += surface.positions[corner] / static_cast<double>(border.size());
  const auto centre = static_cast<std::uint32_t>(surface.positions.size());
  const bool triangle = border.size() == 3;
  if (!triangle) surface.positions.push_back(middle);
  for (std::size_t i = 0; i < (triangle ? 1 : border.size()); ++i) {
    const std::uint32_t third = triangle ? border[2] : centre;
    surface.triangles.emplace_back(border[i], border[(i + 1) % border.size()], third);
    surface.sources.push_back(kCap);
  }
}

}  // namespace pellucid::geocube
