#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "algorithms/scene/shapes/procedural.hpp"

namespace pellucid {
namespace {

struct Direction {
  float cosine;
  float sine;
};

// The i-th of n directions around the circle; the last is bit for bit the first, so that seams close.
Direction around(int i, int n) {
  const double angle = 2.0 * std::numbers::pi * static_cast<double>(i % n) / static_cast<double>(n);
  return {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
}

float share(int i, int n) {
  return static_cast<float>(i) / static_cast<float>(n);
}

void add_vertex(Mesh& mesh, const glm::vec3& position, const glm::vec3& normal, const glm::vec2& uv) {
  mesh.positions.push_back(position);
  mesh.normals.push_back(normal);
  mesh.uvs.push_back(uv);
}

unsigned next_index(const Mesh& mesh) {
  return static_cast<unsigned>(mesh.positions.size());
}

// Triangles of a (columns + 1) × (rows + 1) grid of vertices, row by row from `first`. Seen from outside, columns run
// to the right and rows upwards. A row that is one point has no triangles there.
void add_grid(Mesh& mesh, unsigned first, int columns, int rows, bool pole_below = false, bool pole_above = false) {
  const auto stride = static_cast<unsigned>(columns) + 1;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const unsigned a = first + static_cast<unsigned>(row) * stride + static_cast<unsigned>(column);
      const unsigned b = a + 1, c = a + stride, d = c + 1;
      if (!(pole_below && row == 0)) mesh.triangles.emplace_back(a, b, d);
      if (!(pole_above && row == rows - 1)) mesh.triangles.emplace_back(a, d, c);
    }
  }
}

// A disc at height y that faces +y or −y.
void add_disc(Mesh& mesh, float radius, float y, int segments, bool upwards) {
  const unsigned centre = next_index(mesh);
  const glm::vec3 normal(0.0F, upwards ? 1.0F : -1.0F, 0.0F);
  add_vertex(mesh, {0.0F, y, 0.0F}, normal, {0.5F, 0.5F});
  for (int i = 0; i < segments; ++i) {
    const Direction d = around(i, segments);
    add_vertex(mesh, {radius * d.cosine, y, -radius * d.sine}, normal, {0.5F + 0.5F * d.cosine, 0.5F + 0.5F * d.sine});
  }
  for (int i = 0; i < segments; ++i) {
    const unsigned a = centre + 1 + static_cast<unsigned>(i);
    const unsigned b = centre + 1 + static_cast<unsigned>((i + 1) % segments);
    if (upwards) {
      mesh.triangles.emplace_back(centre, a, b);
    } else {
      mesh.triangles.emplace_back(centre, b, a);
    }
  }
}

}  // namespace

Mesh make_sphere(float radius, int segments) {
  assert(radius > 0.0F && segments >= 3);
  Mesh mesh;
  mesh.name = "sphere";
  const int rows = std::max(2, segments / 2);
  for (int row = 0; row <= rows; ++row) {
    const double polar = std::numbers::pi * static_cast<double>(row) / static_cast<double>(rows);
    const bool pole = row == 0 || row == rows;
    const auto y = static_cast<float>(-std::cos(polar));
    const float ring = pole ? 0.0F : static_cast<float>(std::sin(polar));
    for (int column = 0; column <= segments; ++column) {
      const Direction d = around(column, segments);
      const glm::vec3 normal(ring * d.cosine, y, -ring * d.sine);
      // At a pole each triangle has its own vertex, halfway between its neighbours in u.
      const int shift = row == 0 ? 1 : -1;
      const float u =
          pole ? share(std::clamp(2 * column + shift, 0, 2 * segments), 2 * segments) : share(column, segments);
      add_vertex(mesh, radius * normal, normal, {u, share(row, rows)});
    }
  }
  add_grid(mesh, 0, segments, rows, true, true);
  return mesh;
}

Mesh make_box(const glm::vec3& size) {
  assert(size.x > 0.0F && size.y > 0.0F && size.z > 0.0F);
  Mesh mesh;
  mesh.name = "box";
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0F, 1.0F}) {
      glm::vec3 normal(0.0F), right(0.0F), up(0.0F);
      normal[axis] = sign;
      right[(axis + 1) % 3] = sign;
      up[(axis + 2) % 3] = 1.0F;
      const unsigned first = next_index(mesh);
      for (const float v : {0.0F, 1.0F}) {
        for (const float u : {0.0F, 1.0F}) {
          const glm::vec3 corner = normal + (2.0F * u - 1.0F) * right + (2.0F * v - 1.0F) * up;
          add_vertex(mesh, 0.5F * size * corner, normal, {u, v});
        }
      }
      add_grid(mesh, first, 1, 1);
    }
  }
  return mesh;
}

Mesh make_plane(const glm::vec2& size, int segments) {
  assert(size.x > 0.0F && size.y > 0.0F && segments >= 1);
  Mesh mesh;
  mesh.name = "plane";
  for (int row = 0; row <= segments; ++row) {
    for (int column = 0; column <= segments; ++column) {
      const glm::vec2 uv(share(column, segments), share(row, segments));
      add_vertex(mesh, {(uv.x - 0.5F) * size.x, 0.0F, (0.5F - uv.y) * size.y}, {0.0F, 1.0F, 0.0F}, uv);
    }
  }
  add_grid(mesh, 0, segments, segments);
  return mesh;
}

Mesh make_cylinder(float radius, float height, int segments) {
  assert(radius > 0.0F && height > 0.0F && segments >= 3);
  Mesh mesh;
  mesh.name = "cylinder";
  for (int row = 0; row <= 1; ++row) {
    for (int column = 0; column <= segments; ++column) {
      const Direction d = around(column, segments);
      const glm::vec3 normal(d.cosine, 0.0F, -d.sine);
      const glm::vec3 foot = radius * normal;
      add_vertex(mesh, {foot.x, row == 0 ? 0.0F : height, foot.z}, normal,
                 {share(column, segments), static_cast<float>(row)});
    }
  }
  add_grid(mesh, 0, segments, 1);
  add_disc(mesh, radius, 0.0F, segments, false);
  add_disc(mesh, radius, height, segments, true);
  return mesh;
}

Mesh make_cone(float radius, float height, int segments) {
  assert(radius > 0.0F && height > 0.0F && segments >= 3);
  Mesh mesh;
  mesh.name = "cone";
  // The side's normal rises by radius over height; at the apex each triangle takes the one of its middle.
  const float slant = std::sqrt(radius * radius + height * height);
  const auto side_normal = [&](const Direction& d) {
    return glm::vec3(d.cosine * height, radius, -d.sine * height) / slant;
  };
  for (int column = 0; column <= segments; ++column) {
    const Direction d = around(column, segments);
    add_vertex(mesh, {radius * d.cosine, 0.0F, -radius * d.sine}, side_normal(d), {share(column, segments), 0.0F});
  }
  for (int column = 0; column < segments; ++column) {
    add_vertex(mesh, {0.0F, height, 0.0F}, side_normal(around(2 * column + 1, 2 * segments)),
               {share(2 * column + 1, 2 * segments), 1.0F});
  }
  for (int column = 0; column < segments; ++column) {
    const auto a = static_cast<unsigned>(column);
    mesh.triangles.emplace_back(a, a + 1, a + static_cast<unsigned>(segments) + 1);
  }
  add_disc(mesh, radius, 0.0F, segments, false);
  return mesh;
}

Mesh make_torus(float major_radius, float minor_radius, int segments) {
  assert(minor_radius > 0.0F && major_radius > 0.0F && segments >= 3);
  Mesh mesh;
  mesh.name = "torus";
  const int rows = std::max(3, segments / 2);
  for (int row = 0; row <= rows; ++row) {
    const Direction tube = around(row, rows);
    for (int column = 0; column <= segments; ++column) {
      const Direction d = around(column, segments);
      const glm::vec3 outwards(d.cosine, 0.0F, -d.sine);
      const glm::vec3 normal = tube.cosine * outwards + glm::vec3(0.0F, tube.sine, 0.0F);
      add_vertex(mesh, major_radius * outwards + minor_radius * normal, normal,
                 {share(column, segments), share(row, rows)});
    }
  }
  add_grid(mesh, 0, segments, rows);
  return mesh;
}

}  // namespace pellucid
