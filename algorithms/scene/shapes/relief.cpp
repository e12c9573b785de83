#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "algorithms/scene/noise.hpp"
#include "algorithms/scene/shapes/procedural.hpp"

namespace pellucid {

namespace {

/// Height at a point of the plane, its shorter side as unit.
float relief_height(const ReliefOptions& options, const glm::vec2& p) {
  const glm::vec3 at(p.x * options.frequency, 0.5F, p.y * options.frequency);
  // Octaves rarely add up: half of the bound already counts as highest or lowest.
  const float ground = std::clamp(fractal_noise(at, options.octaves, options.seed), -0.5F, 0.5F);
  if (options.ripples == 0.0F) return options.height_m * ground;
  // Ripples follow lines that the noise bends.
  constexpr float kRipples = 3.0F;  // for each period of the noise
  const float bend = gradient_noise(0.6F * at + 7.3F, options.seed + 101U);
  const float phase = kRipples * (0.35F * at.x + 0.94F * at.z + 1.2F * bend);
  const float ripple = 0.5F * std::sin(2.0F * std::numbers::pi_v<float> * phase);
  return options.height_m * glm::mix(ground, ripple, options.ripples);
}

}  // namespace

Mesh make_relief(const ReliefOptions& options) {
  assert(options.segments >= 1 && options.octaves >= 1 && options.size.x > 0.0F && options.size.y > 0.0F);
  const float shorter = std::min(options.size.x, options.size.y);
  const auto along = [&](float side) {
    return std::max(1, static_cast<int>(std::lround(static_cast<float>(options.segments) * side / shorter)));
  };
  const int columns = along(options.size.x), rows = along(options.size.y);
  const auto height = [&](const glm::vec2& p) { return relief_height(options, p / shorter); };
  const float step = 0.25F * shorter / static_cast<float>(options.segments);

  Mesh mesh;
  mesh.name = "relief";
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const glm::vec2 uv(static_cast<float>(i) / static_cast<float>(columns),
                         static_cast<float>(j) / static_cast<float>(rows));
      const glm::vec2 p = (uv - 0.5F) * options.size;
      const float slope_x = height(p + glm::vec2(step, 0)) - height(p - glm::vec2(step, 0));
      const float slope_z = height(p + glm::vec2(0, step)) - height(p - glm::vec2(0, step));
      mesh.positions.emplace_back(p.x, height(p), p.y);
      mesh.normals.push_back(glm::normalize(glm::vec3(-slope_x, 2.0F * step, -slope_z)));
      mesh.uvs.push_back(uv);
    }
  }
  const auto vertex = [&](int i, int j) { return static_cast<std::uint32_t>(j * (columns + 1) + i); };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const glm::uvec2 near(vertex(i, j), vertex(i + 1, j)), far(vertex(i, j + 1), vertex(i + 1, j + 1));
      mesh.triangles.emplace_back(near.x, far.x, near.y);
      mesh.triangles.emplace_back(near.y, far.x, far.y);
    }
  }
  // Sides, each with vertices of its own for the flat normals.
  const auto add_side = [&](int count, const glm::vec3& normal, auto&& vertex_at) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (int i = 0; i <= count; ++i) {
      const glm::vec3 top = mesh.positions[vertex_at(i)];
      const glm::vec2 uv = mesh.uvs[vertex_at(i)];
      for (const float y : {top.y, -0.5F * options.height_m}) {
        mesh.positions.emplace_back(top.x, y, top.z);
        mesh.normals.push_back(normal);
        mesh.uvs.push_back(uv);
      }
    }
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i) {
      const std::uint32_t top = first + 2 * i;
      mesh.triangles.emplace_back(top, top + 1, top + 2);
      mesh.triangles.emplace_back(top + 2, top + 1, top + 3);
    }
  };
  add_side(columns, {0, 0, 1}, [&](int i) { return vertex(i, rows); });
  add_side(columns, {0, 0, -1}, [&](int i) { return vertex(columns - i, 0); });
  add_side(rows, {1, 0, 0}, [&](int j) { return vertex(columns, rows - j); });
  add_side(rows, {-1, 0, 0}, [&](int j) { return vertex(0, j); });
  return mesh;
}

}  // namespace pellucid
