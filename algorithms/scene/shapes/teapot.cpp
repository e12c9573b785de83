#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

#include "algorithms/scene/shapes/procedural.hpp"

// Martin Newell's teapot of 1975 in its 32-patch form, bottom included (the data are in the public domain). Rim, body,
// lid and bottom are surfaces of revolution, so a control row is a radius, a height and where the circle's inner
// control points lie; handle and spout are mirrored at y = 0. z is up here; make_teapot() turns it to y up.
namespace pellucid {
namespace {

using Patch = std::array<std::array<glm::dvec3, 4>, 4>;  // [row][column]

constexpr double kCircle = 0.56;  // Newell's place of a quadrant's inner control points

struct Ring {
  double radius;
  double z;
  double circle = kCircle;
};
constexpr std::array<std::array<Ring, 4>, 6> kProfiles = {{
    {{{1.4, 2.4}, {1.3375, 2.53125}, {1.4375, 2.53125}, {1.5, 2.4}}},  // rim
    {{{1.5, 2.4}, {1.75, 1.875}, {2.0, 1.35}, {2.0, 0.9}}},            // body, upper
    {{{2.0, 0.9}, {2.0, 0.45}, {1.5, 0.225}, {1.5, 0.15}}},            // body, lower
    {{{0.0, 3.15}, {0.8, 3.15, 0.5625}, {0.0, 2.85}, {0.2, 2.7}}},     // lid's knob
    {{{0.2, 2.7}, {0.4, 2.55}, {1.3, 2.55}, {1.3, 2.4}}},              // lid
    {{{1.5, 0.15}, {1.5, 0.075}, {1.425, 0.0}, {0.0, 0.0}}},           // bottom
}};

struct Row {  // from the plane of symmetry, outwards, and back to it
  std::array<double, 4> x;
  double width;  // −y of the two middle points
  std::array<double, 4> z;
};
constexpr std::array<std::array<Row, 4>, 4> kMirrored = {{
    // handle, upper
    {{{{-1.6, -1.6, -1.5, -1.5}, 0.3, {2.025, 2.025, 2.25, 2.25}},
      {{-2.3, -2.3, -2.5, -2.5}, 0.3, {2.025, 2.025, 2.25, 2.25}},
      {{-2.7, -2.7, -3.0, -3.0}, 0.3, {2.025, 2.025, 2.25, 2.25}},
      {{-2.7, -2.7, -3.0, -3.0}, 0.3, {1.8, 1.8, 1.8, 1.8}}}},
    // handle, lower
    {{{{-2.7, -2.7, -3.0, -3.0}, 0.3, {1.8, 1.8, 1.8, 1.8}},
      {{-2.7, -2.7, -3.0, -3.0}, 0.3, {1.575, 1.575, 1.35, 1.35}},
      {{-2.5, -2.5, -2.65, -2.65}, 0.3, {1.125, 1.125, 0.9375, 0.9375}},
      {{-2.0, -2.0, -1.9, -1.9}, 0.3, {0.9, 0.9, 0.6, 0.6}}}},
    // spout, lower
    {{{{1.7, 1.7, 1.7, 1.7}, 0.66, {1.425, 1.425, 0.6, 0.6}},
      {{2.6, 2.6, 3.1, 3.1}, 0.66, {1.425, 1.425, 0.825, 0.825}},
      {{2.3, 2.3, 2.4, 2.4}, 0.25, {2.1, 2.1, 2.025, 2.025}},
      {{2.7, 2.7, 3.3, 3.3}, 0.25, {2.4, 2.4, 2.4, 2.4}}}},
    // spout, upper
    {{{{2.7, 2.7, 3.3, 3.3}, 0.25, {2.4, 2.4, 2.4, 2.4}},
      {{2.8, 2.8, 3.525, 3.525}, 0.25, {2.475, 2.475, 2.49375, 2.49375}},
      {{2.9, 2.9, 3.45, 3.45}, 0.15, {2.475, 2.475, 2.5125, 2.5125}},
      {{2.8, 2.8, 3.2, 3.2}, 0.15, {2.4, 2.4, 2.4, 2.4}}}},
}};

// Exact quarter turns about z, so that neighbouring quadrants share their border bit for bit.
glm::dvec3 quarter_turns(const glm::dvec3& p, int turns) {
  switch (turns) {
    case 1:
      return {-p.y, p.x, p.z};
    case 2:
      return {-p.x, -p.y, p.z};
    case 3:
      return {p.y, -p.x, p.z};
    default:
      return p;
  }
}

// All 32 patches, oriented so that ∂S/∂row × ∂S/∂column points outwards.
std::vector<Patch> make_patches() {
  std::vector<Patch> patches;
  for (const auto& profile : kProfiles) {
    for (int quadrant = 0; quadrant < 4; ++quadrant) {
      Patch patch;
      for (std::size_t row = 0; row < 4; ++row) {
        const Ring& ring = profile[row];
        const double r = ring.radius, inner = r * ring.circle;
        const std::array<glm::dvec3, 4> arc = {
            {{r, 0, ring.z}, {r, inner, ring.z}, {inner, r, ring.z}, {0, r, ring.z}}};
        for (std::size_t column = 0; column < 4; ++column)
          patch[row][column] = quarter_turns(arc[column], quadrant);
      }
      patches.push_back(patch);
    }
  }
  for (std::size_t part = 0; part < kMirrored.size(); ++part) {
    for (const double side : {-1.0, 1.0}) {
      Patch patch;
      const bool flip = side < 0.0;
      for (std::size_t row = 0; row < 4; ++row) {
        const Row& control = kMirrored[part][row];
        for (std::size_t column = 0; column < 4; ++column) {
          const double width = column == 1 || column == 2 ? control.width : 0.0;
          patch[row][flip ? 3 - column : column] = {control.x[column], side * width, control.z[column]};
        }
      }
      patches.push_back(patch);
    }
  }
  return patches;
}

struct Basis {
  std::array<double, 4> value;
  std::array<double, 4> slope;
};
Basis bernstein(double t) {
  const double s = 1.0 - t;
  return {{s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t},
          {-3.0 * s * s, 3.0 * s * s - 6.0 * s * t, 6.0 * s * t - 3.0 * t * t, 3.0 * t * t}};
}

struct Sample {
  glm::dvec3 position{0.0};
  glm::dvec3 along_row{0.0};
  glm::dvec3 along_column{0.0};
};
Sample evaluate(const Patch& patch, const Basis& row, const Basis& column) {
  Sample s;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      s.position += row.value[i] * column.value[j] * patch[i][j];
      s.along_row += row.slope[i] * column.value[j] * patch[i][j];
      s.along_column += row.value[i] * column.slope[j] * patch[i][j];
    }
  }
  return s;
}

// The surface's normal; at the lid's and the bottom's centre, where a whole row is one point, the axis of revolution.
glm::dvec3 outward_normal(const Sample& s) {
  const glm::dvec3 n = glm::cross(s.along_row, s.along_column);
  const double length = glm::length(n);
  if (length > 1e-9) return n / length;
  return {0.0, 0.0, s.position.z > 1.0 ? 1.0 : -1.0};
}

}  // namespace

Mesh make_teapot(float scale, int subdivisions) {
  assert(scale > 0.0F && subdivisions >= 1);
  Mesh mesh;
  mesh.name = "teapot";
  const double size = 0.5 * static_cast<double>(scale);
  const auto n = static_cast<unsigned>(subdivisions);
  std::vector<Basis> basis(n + 1);
  for (unsigned i = 0; i <= n; ++i)
    basis[i] = bernstein(static_cast<double>(i) / static_cast<double>(n));

  for (const Patch& patch : make_patches()) {
    const auto first = static_cast<unsigned>(mesh.positions.size());
    for (unsigned row = 0; row <= n; ++row) {
      for (unsigned column = 0; column <= n; ++column) {
        const Sample s = evaluate(patch, basis[row], basis[column]);
        const glm::dvec3 normal = outward_normal(s);
        const glm::dvec3 p = size * s.position;
        mesh.positions.emplace_back(p.x, p.z, -p.y);
        mesh.normals.emplace_back(normal.x, normal.z, -normal.y);
        mesh.uvs.emplace_back(static_cast<float>(column) / static_cast<float>(n),
                              1.0F - static_cast<float>(row) / static_cast<float>(n));
      }
    }
    for (unsigned row = 0; row < n; ++row) {
      for (unsigned column = 0; column < n; ++column) {
        const unsigned a = first + row * (n + 1) + column, b = a + 1, c = a + n + 1, d = c + 1;
        // Leave out the triangles that a row collapsed to a point would make.
        if (mesh.positions[a] != mesh.positions[b]) mesh.triangles.emplace_back(a, d, b);
        if (mesh.positions[c] != mesh.positions[d]) mesh.triangles.emplace_back(a, c, d);
      }
    }
  }
  return mesh;
}

}  // namespace pellucid
