#include "algorithms/translucent_relief/caustic_charts.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "algorithms/scene/meshes/connected_parts.hpp"
#include "algorithms/scene/meshes/tangents.hpp"
#include "gl/error.hpp"

namespace pellucid::translucent_relief {
namespace {

// A node on a triangle's edge belongs to it; one so far inside, by its least weight, lies on no other of a plain
// layout.
constexpr float kOnEdge = 1e-4F, kInside = 1e-3F;

/// A node and its weights in a triangle.
struct Covered {
  std::size_t node;
  glm::vec3 weights;
  bool inside() const { return std::min({weights.x, weights.y, weights.z}) > kInside; }
};

std::vector<Covered> covered_by(const Mesh& mesh, const glm::uvec3& t, int side) {
  const float cells = static_cast<float>(side - 1);
  const glm::vec2 a = mesh.uvs[t.x] * cells, b = mesh.uvs[t.y] * cells, c = mesh.uvs[t.z] * cells;
  const float twice_area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
  std::vector<Covered> covered;
  if (std::abs(twice_area) < 1e-12F) return covered;
  const glm::vec2 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
  const auto first = [&](float x) { return std::clamp(static_cast<int>(std::ceil(x - 1e-3F)), 0, side - 1); };
  const auto last = [&](float x) { return std::clamp(static_cast<int>(std::floor(x + 1e-3F)), 0, side - 1); };
  for (int y = first(low.y); y <= last(high.y); ++y) {
    for (int x = first(low.x); x <= last(high.x); ++x) {
      const glm::vec2 p(x, y);
      const auto weight = [&](const glm::vec2& from, const glm::vec2& to) {
        return ((to.x - from.x) * (p.y - from.y) - (p.x - from.x) * (to.y - from.y)) / twice_area;
      };
      const glm::vec3 weights(weight(b, c), weight(c, a), weight(a, b));
      if (std::min({weights.x, weights.y, weights.z}) < -kOnEdge) continue;
      covered.push_back(
          {static_cast<std::size_t>(y) * static_cast<std::size_t>(side) + static_cast<std::size_t>(x), weights});
    }
  }
  return covered;
}

// Continues the mesh to the nodes around it, so that cells on its border are whole.
void continue_around(std::vector<CausticNode>& nodes, int side) {
  const std::vector<CausticNode> before = nodes;
  const auto index = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(side) + static_cast<std::size_t>(x);
  };
  const float cell = 1.0F / static_cast<float>(side - 1);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      CausticNode& node = nodes[index(x, y)];
      for (int i = 0; i < 9 && node.position.w == 0.0F; ++i) {
        const int dx = i % 3 - 1, dy = i / 3 - 1;
        if (std::min(x + dx, y + dy) < 0 || std::max(x + dx, y + dy) >= side) continue;
        const CausticNode& next = before[index(x + dx, y + dy)];
        if (next.position.w == 0.0F) continue;
        node = next;
        node.position -= cell * (static_cast<float>(dx) * next.over_u + static_cast<float>(dy) * next.over_v);
      }
    }
  }
}

// Whether over u, and over v, the layer's first and last nodes are the same places.
glm::bvec2 closes(const std::vector<CausticNode>& nodes, int side, float tolerance) {
  const auto both = [&](int step_along, int step_across) {
    bool some = false;
    for (int i = 0; i < side; ++i) {
      const CausticNode& first = nodes[static_cast<std::size_t>(i * step_along)];
      const CausticNode& last = nodes[static_cast<std::size_t>(i * step_along + (side - 1) * step_across)];
      if (first.position.w == 0.0F && last.position.w == 0.0F) continue;
      if (first.position.w != last.position.w) return false;
      if (glm::distance(first.position, last.position) > tolerance) return false;
      some = true;
    }
    return some;
  };
  return {both(side, 1), both(1, side)};
}

// All of the mesh in one plane, with positions that are linear in the texture's coordinates.
bool is_affine(const Mesh& mesh, const Tangents& tangents) {
  float size = 0, off = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec2 way = mesh.uvs[i] - mesh.uvs[0];
    const glm::vec3 from_first = mesh.positions[i] - mesh.positions[0];
    size = std::max(size, glm::length(from_first));
    off = std::max(off, glm::distance(from_first, way.x * tangents.u[0] + way.y * tangents.v[0]));
  }
  return off < 1e-4F * size;
}

}  // namespace

CausticCharts caustic_charts(const Mesh& mesh, int side, const std::string& what) {
  assert(side >= 2);
  const Tangents tangents = tangents_of(mesh, what);
  const auto refuse = [&](const std::string& why) {
    return InputError(fmt::format("translucent_relief: caustics = true cannot lie on {}: {}", what, why));
  };
  for (const glm::vec2& uv : mesh.uvs) {
    if (!(std::min(uv.x, uv.y) >= -1e-5F && std::max(uv.x, uv.y) <= 1.00001F))
      throw refuse("its texture coordinates go beyond [0, 1]");
  }
  CausticCharts charts;
  charts.side = side;
  charts.layer_of_triangle.resize(mesh.triangles.size());
  charts.affine = is_affine(mesh, tangents);
  const ConnectedParts parts = connected_parts(mesh);
  std::vector<std::vector<std::size_t>> pieces(static_cast<std::size_t>(parts.count));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    pieces[static_cast<std::size_t>(parts.of_vertex[mesh.triangles[i].x])].push_back(i);

  const std::size_t nodes = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
  std::vector<std::vector<bool>> taken;  // by layer, nodes inside a triangle
  for (const std::vector<std::size_t>& triangles : pieces) {
    std::vector<std::pair<std::size_t, Covered>> all;
    std::vector<bool> own(nodes, false);
    for (const std::size_t i : triangles) {
      for (const Covered& at : covered_by(mesh, mesh.triangles[i], side)) {
        if (at.inside() && own[at.node])
          throw refuse("parts of it that hang together have the same texture coordinates");
        if (at.inside()) own[at.node] = true;
        all.emplace_back(i, at);
      }
    }
    std::size_t layer = 0;
    const auto is_free = [&] {
      return std::none_of(all.begin(), all.end(), [&](const auto& entry) { return taken[layer][entry.second.node]; });
    };
    while (layer < taken.size() && !is_free())
      ++layer;
    if (layer == taken.size()) {
      if (layer == static_cast<std::size_t>(kMostCausticLayers)) {
        throw refuse(fmt::format("more than {} pieces of it have the same texture coordinates", kMostCausticLayers));
      }
      taken.emplace_back(nodes, false);
      charts.layers.emplace_back(nodes);
    }
    for (const auto& [i, at] : all) {
      const glm::uvec3& t = mesh.triangles[i];
      const auto mixed = [&t, &w = at.weights](const std::vector<glm::vec3>& values) {
        return w.x * values[t.x] + w.y * values[t.y] + w.z * values[t.z];
      };
      charts.layers[layer][at.node] = {glm::vec4(mixed(mesh.positions), 1.0F), glm::vec4(mixed(mesh.normals), 0.0F),
                                       glm::vec4(mixed(tangents.u), 0.0F), glm::vec4(mixed(tangents.v), 0.0F)};
      taken[layer][at.node] = true;
    }
    for (const std::size_t i : triangles)
      charts.layer_of_triangle[i] = static_cast<std::uint32_t>(layer);
  }
  float size = 0;
  for (const glm::vec3& position : mesh.positions)
    size = std::max(size, glm::distance(position, mesh.positions[0]));
  for (std::vector<CausticNode>& layer : charts.layers) {
    charts.closes.push_back(closes(layer, side, 1e-4F * size));
    continue_around(layer, side);
  }
  return charts;
}

}  // namespace pellucid::translucent_relief
