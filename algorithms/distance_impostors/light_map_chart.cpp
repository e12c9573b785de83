#include "algorithms/distance_impostors/light_map_chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "algorithms/scene/meshes/connected_parts.hpp"

namespace pellucid::distance_impostors {
namespace {

constexpr int kGrid = 128;  // on which overlaps are looked for
constexpr double kOverlapping =
    0.01;  // share of the covered points that may be covered twice, by the rounding of edges

double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

// Counts how many triangles lie over each point of a grid over [0, 1]².
bool apart(const Mesh& mesh, const std::vector<glm::vec2>& places) {
  std::vector<int> counts(static_cast<std::size_t>(kGrid) * kGrid, 0);
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec2 a(places[t.x]), b(places[t.y]), c(places[t.z]);
    const double whole = cross(b - a, c - a);
    if (whole == 0) continue;
    const auto bound = [&](double value) {
      return std::clamp(static_cast<int>(std::floor(value * kGrid)), 0, kGrid - 1);
    };
    const glm::dvec2 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
    for (int y = bound(low.y); y <= bound(high.y); ++y) {
      for (int x = bound(low.x); x <= bound(high.x); ++x) {
        // Off the middle, so that edges between whole fractions are not met.
        const glm::dvec2 p((x + 0.4937) / kGrid, (y + 0.5071) / kGrid);
        const double u = cross(b - a, p - a) / whole, v = cross(p - a, c - a) / whole;
        if (u >= 0 && v >= 0 && u + v <= 1) ++counts[static_cast<std::size_t>(y) * kGrid + static_cast<std::size_t>(x)];
      }
    }
  }
  const auto covered = std::count_if(counts.begin(), counts.end(), [](int n) { return n > 0; });
  const auto twice = std::count_if(counts.begin(), counts.end(), [](int n) { return n > 1; });
  return static_cast<double>(twice) <= kOverlapping * static_cast<double>(covered);
}

bool in_unit_square(const std::vector<glm::vec2>& places) {
  return std::all_of(places.begin(), places.end(), [](const glm::vec2& p) {
    return p.x >= -1e-5F && p.y >= -1e-5F && p.x <= 1 + 1e-5F && p.y <= 1 + 1e-5F;
  });
}

}  // namespace

std::optional<LightMapChart> make_chart(const Mesh& mesh, int texels, int margin) {
  if (mesh.uvs.size() != mesh.positions.size() || mesh.uvs.empty()) return std::nullopt;
  LightMapChart chart{mesh.uvs, std::vector<int>(mesh.positions.size(), 0), 1};
  if (in_unit_square(chart.places) && apart(mesh, chart.places)) return chart;

  ConnectedParts connected = connected_parts(mesh);
  chart.parts = std::move(connected.of_vertex);
  chart.part_count = connected.count;
  if (chart.part_count > kMaxParts) return std::nullopt;
  const auto parts = static_cast<std::size_t>(chart.part_count);
  std::vector<glm::vec2> low(parts, glm::vec2(1e30F)), high(parts, glm::vec2(-1e30F));
  for (std::size_t v = 0; v < mesh.uvs.size(); ++v) {
    const auto part = static_cast<std::size_t>(chart.parts[v]);
    low[part] = glm::min(low[part], mesh.uvs[v]);
    high[part] = glm::max(high[part], mesh.uvs[v]);
  }
  const int side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(chart.part_count))));
  const float cell = 1.0F / static_cast<float>(side);
  const float inset = static_cast<float>(margin) / static_cast<float>(texels);
  if (2 * inset >= cell) return std::nullopt;
  for (std::size_t v = 0; v < mesh.uvs.size(); ++v) {
    const auto part = static_cast<std::size_t>(chart.parts[v]);
    const glm::vec2 within = (mesh.uvs[v] - low[part]) / glm::max(high[part] - low[part], glm::vec2(1e-9F));
    const glm::vec2 corner(static_cast<float>(chart.parts[v] % side), static_cast<float>(chart.parts[v] / side));
    chart.places[v] = corner * cell + inset + within * (cell - 2 * inset);
  }
  if (!apart(mesh, chart.places)) return std::nullopt;
  return chart;
}

}  // namespace pellucid::distance_impostors
