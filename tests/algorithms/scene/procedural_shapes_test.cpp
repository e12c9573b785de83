#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <tuple>

#include <gtest/gtest.h>

#include "algorithms/scene/shapes/procedural.hpp"

namespace pellucid {
namespace {

using std::numbers::pi;

glm::dvec3 corner(const Mesh& mesh, const glm::uvec3& triangle, int i) {
  return glm::dvec3(mesh.positions[triangle[i]]);
}

glm::dvec3 area_vector(const Mesh& mesh, const glm::uvec3& t) {
  return 0.5 * glm::cross(corner(mesh, t, 1) - corner(mesh, t, 0), corner(mesh, t, 2) - corner(mesh, t, 0));
}

double area(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += glm::length(area_vector(mesh, t));
  return sum;
}

// By the divergence theorem; positive when the triangles face outwards.
double volume(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += glm::dot(corner(mesh, t, 0), area_vector(mesh, t)) / 3.0;
  return sum;
}

using Position = std::tuple<float, float, float>;
using Edge = std::pair<Position, Position>;

// How often each directed edge occurs, positions compared bit for bit (−0 equals 0).
std::map<Edge, int> directed_edges(const Mesh& mesh) {
  std::map<Edge, int> edges;
  const auto key = [&](unsigned i) {
    const glm::vec3 p = mesh.positions[i] + glm::vec3(0.0F);
    return Position{p.x, p.y, p.z};
  };
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i)
      ++edges[{key(t[i]), key(t[(i + 1) % 3])}];
  }
  return edges;
}

void expect_closed(const Mesh& mesh) {
  const auto edges = directed_edges(mesh);
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1) << mesh.name << ": an edge is used twice in one direction";
    ASSERT_TRUE(edges.contains({edge.second, edge.first})) << mesh.name << ": an edge has one triangle only";
  }
}

// `agreement`: least cosine between a triangle and its normals.
void expect_sound(const Mesh& mesh, double agreement = 0.6) {
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  ASSERT_TRUE(mesh.uvs.empty() || mesh.uvs.size() == mesh.positions.size());
  for (const auto& n : mesh.normals)
    ASSERT_NEAR(glm::length(n), 1.0F, 1e-5F) << mesh.name;
  for (const auto& uv : mesh.uvs) {
    ASSERT_TRUE(uv.x >= 0.0F && uv.x <= 1.0F && uv.y >= 0.0F && uv.y <= 1.0F) << mesh.name;
  }
  for (const auto& t : mesh.triangles) {
    const glm::dvec3 a = area_vector(mesh, t);
    ASSERT_GT(glm::length(a), 0.0) << mesh.name << ": a degenerate triangle";
    for (int i = 0; i < 3; ++i) {
      ASSERT_LT(t[i], mesh.positions.size());
      ASSERT_GT(glm::dot(glm::normalize(a), glm::dvec3(mesh.normals[t[i]])), agreement)
          << mesh.name << ": normal and winding";
    }
  }
}

TEST(ProceduralShapes, AreSoundAndClosed) {
  for (const int segments : {4, 5, 17, 48}) {
    for (const Mesh& mesh : {make_sphere(1.3F, 4 * segments), make_cylinder(0.4F, 2.0F, 3 * segments),
                             make_cone(0.7F, 1.1F, 3 * segments), make_torus(1.0F, 0.3F, 3 * segments)}) {
      expect_sound(mesh);
      expect_closed(mesh);
    }
  }
  expect_closed(make_sphere(1.0F, 4));  // an octahedron
  expect_closed(make_sphere(1.0F, 3));
  expect_closed(make_torus(0.2F, 0.5F, 3));  // cuts through itself
  expect_sound(make_box({1, 2, 3}));
  expect_closed(make_box({1, 2, 3}));
  expect_sound(make_plane({2, 3}, 5));
}

TEST(ProceduralShapes, SphereMatchesClosedForm) {
  const Mesh mesh = make_sphere(2.0F, 256);
  EXPECT_NEAR(volume(mesh), 4.0 / 3.0 * pi * 8.0, 0.02);
  EXPECT_NEAR(area(mesh), 4.0 * pi * 4.0, 0.02);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_LT(glm::distance(mesh.positions[i], 2.0F * mesh.normals[i]), 1e-5F);
  }
}

TEST(ProceduralShapes, BoxHasItsSizeAboutTheOrigin) {
  const Mesh mesh = make_box({1, 2, 3});
  EXPECT_NEAR(volume(mesh), 6.0, 1e-6);
  EXPECT_NEAR(area(mesh), 2.0 * (2 + 3 + 6), 1e-6);
  for (const auto& p : mesh.positions)
    EXPECT_EQ(glm::abs(p), glm::vec3(0.5F, 1.0F, 1.5F));
}

TEST(ProceduralShapes, CylinderAndConeMatchThePrismAndThePyramid) {
  const int n = 24;
  const double base = 0.5 * n * std::sin(2.0 * pi / n) * 0.4 * 0.4;
  EXPECT_NEAR(volume(make_cylinder(0.4F, 2.0F, n)), base * 2.0, 1e-6);
  EXPECT_NEAR(volume(make_cone(0.4F, 2.0F, n)), base * 2.0 / 3.0, 1e-6);
  const double perimeter = 2.0 * n * std::sin(pi / n) * 0.4;
  EXPECT_NEAR(area(make_cylinder(0.4F, 2.0F, n)), 2.0 * base + perimeter * 2.0, 1e-5);
}

TEST(ProceduralShapes, ConeNormalsStandOnTheSlant) {
  const Mesh mesh = make_cone(3.0F, 4.0F, 64);
  // Radius 3 and height 4: the side's normal rises by 3/5.
  for (int i = 0; i < 65; ++i)
    EXPECT_NEAR(mesh.normals[static_cast<std::size_t>(i)].y, 0.6F, 1e-6F);
}

TEST(ProceduralShapes, TorusMatchesPappus) {
  const Mesh mesh = make_torus(1.0F, 0.25F, 256);
  EXPECT_NEAR(volume(mesh), 2.0 * pi * pi * 0.0625, 2e-3);
  EXPECT_NEAR(area(mesh), 4.0 * pi * pi * 0.25, 5e-3);
}

TEST(ProceduralShapes, StarsAreSoundClosedAndAsLargeAsTheFormulaSays) {
  for (const StarOptions& options : {StarOptions{}, StarOptions{1.5F, 7, 0.2F}, StarOptions{0.5F, 1, 0.8F}}) {
    const Mesh mesh = make_star(options, 256);
    expect_sound(mesh, 0.5);
    expect_closed(mesh);
    // r³/3 over all directions: odd powers of the cosine vanish.
    const double r = static_cast<double>(options.radius), a = static_cast<double>(options.amplitude);
    EXPECT_NEAR(volume(mesh), r * r * r * pi * (4.0 / 3.0 + 16.0 / 15.0 * a * a), 0.004 * r * r * r);
  }
  const Mesh ball = make_star({2.0F, 5, 0.0F}, 32);
  for (std::size_t i = 0; i < ball.positions.size(); ++i)
    EXPECT_LT(glm::distance(ball.positions[i], 2.0F * ball.normals[i]), 1e-6F);
}

TEST(ProceduralShapes, AStarsNormalsAreTheSlopeOfItsSurface) {
  const StarOptions options{0.8F, 4, 0.45F};
  const Mesh mesh = make_star(options, 40);
  const auto field = [&](const glm::dvec3& p) { return glm::length(p) - star_radius(options, glm::normalize(p)); };
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::dvec3 p(mesh.positions[i]);
    EXPECT_NEAR(field(p), 0, 1e-6);
    glm::dvec3 slope(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 step(0.0);
      step[axis] = 1e-5;
      slope[axis] = (field(p + step) - field(p - step)) / 2e-5;
    }
    EXPECT_LT(glm::distance(glm::dvec3(mesh.normals[i]), glm::normalize(slope)), 1e-4) << i;
  }
}

TEST(ProceduralShapes, PlaneFacesUp) {
  const Mesh mesh = make_plane({2, 3}, 4);
  EXPECT_EQ(mesh.triangles.size(), 32U);
  EXPECT_NEAR(area(mesh), 6.0, 1e-6);
  for (const auto& t : mesh.triangles)
    EXPECT_GT(area_vector(mesh, t).y, 0.0);
}

// ---- the teapot ----

struct Bounds {
  glm::vec3 low{1e9F}, high{-1e9F};
};
Bounds bounds(const Mesh& mesh) {
  Bounds b;
  for (const auto& p : mesh.positions) {
    b.low = glm::min(b.low, p);
    b.high = glm::max(b.high, p);
  }
  return b;
}

TEST(ProceduralTeapot, HasNewellsProportions) {
  const Bounds b = bounds(make_teapot(2.0F, 16));
  EXPECT_NEAR(b.low.y, 0.0F, 1e-6F);
  EXPECT_NEAR(b.high.y, 3.15F, 1e-5F);
  EXPECT_NEAR(b.low.z, -2.0F, 1e-5F);  // the body's radius
  EXPECT_NEAR(b.high.z, 2.0F, 1e-5F);
  EXPECT_NEAR(b.low.x, -3.0F, 1e-5F);    // the handle
  EXPECT_NEAR(b.high.x, 3.434F, 2e-3F);  // the spout's lip
  const Bounds half = bounds(make_teapot(1.0F, 16));
  EXPECT_NEAR(half.high.y, 1.575F, 1e-5F);
}

TEST(ProceduralTeapot, NormalsAgreeWithWinding) {
  expect_sound(make_teapot(1.0F, 10), 0.0);  // the spout's lip is as sharp as a triangle
  expect_sound(make_teapot(1.0F, 64));
}

// Patches meet without gap and without crease: only the rim's inner edge, the lid's edge and both ends of handle and
// spout are open, four circles of 4n edges in all, and vertices in one place have one normal.
TEST(ProceduralTeapot, PatchesAreJoined) {
  const int n = 7;
  const Mesh mesh = make_teapot(1.0F, n);
  using Place = std::tuple<long, long, long>;
  const auto place = [&](unsigned i) {
    const glm::vec3 p = mesh.positions[i];
    return Place{std::lround(p.x * 1e5F), std::lround(p.y * 1e5F), std::lround(p.z * 1e5F)};
  };
  std::map<std::pair<Place, Place>, int> edges;
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i)
      ++edges[{place(t[i]), place(t[(i + 1) % 3])}];
  }
  int open = 0;
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    open += edges.contains({edge.second, edge.first}) ? 0 : 1;
  }
  EXPECT_EQ(open, 4 * 4 * n);

  // Rim, body and bottom are one shell; lid, handle and spout are others, and the handle touches the body.
  const auto shell = [&](unsigned i) {
    const int patch = static_cast<int>(i) / ((n + 1) * (n + 1));
    return patch < 12 || (patch >= 20 && patch < 24) ? 0 : patch < 20 ? 1 : patch < 28 ? 2 : 3;
  };
  std::map<std::pair<int, Place>, glm::vec3> normal;
  std::size_t shared = 0;
  for (unsigned i = 0; i < mesh.positions.size(); ++i) {
    const auto [it, fresh] = normal.try_emplace({shell(i), place(i)}, mesh.normals[i]);
    if (fresh) continue;
    ++shared;
    EXPECT_GT(glm::dot(it->second, mesh.normals[i]), 0.9999F);
  }
  EXPECT_GT(shared, 300U);
}

TEST(ProceduralTeapot, BodyFacesOutwards) {
  const int n = 8;
  const Mesh mesh = make_teapot(1.0F, n);
  // The body's eight patches follow the rim's four.
  const auto per_patch = static_cast<std::size_t>((n + 1) * (n + 1));
  for (std::size_t i = 4 * per_patch; i < 12 * per_patch; ++i) {
    const glm::vec3 p = mesh.positions[i];
    EXPECT_GT(glm::dot(mesh.normals[i], glm::vec3(p.x, 0.0F, p.z)), 0.0F);
  }
  // The bottom is there, flat in the middle, and looks down.
  bool bottom = false;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (glm::length(mesh.positions[i]) < 1e-4F) {
      bottom = true;
      EXPECT_LT(mesh.normals[i].y, -0.999F);
    }
  }
  EXPECT_TRUE(bottom);
}

TEST(Tiles, CoverThePlaneOnceInFlatColors) {
  for (const bool running : {false, true}) {
    TileOptions options;
    options.size = {3, 2};
    options.columns = 5;
    options.rows = 4;
    options.joint = 0.1F;
    options.running = running;
    const Mesh mesh = make_tiles(options);
    EXPECT_NEAR(area(mesh), 6.0, 1e-5);
    double tiles_area = 0;
    float lightest = 0;
    for (const auto& t : mesh.triangles) {
      EXPECT_GT(area_vector(mesh, t).y, 0.0);  // faces +y
      EXPECT_EQ(mesh.colors[t[0]], mesh.colors[t[1]]);
      EXPECT_EQ(mesh.colors[t[0]], mesh.colors[t[2]]);
      for (int i = 0; i < 3; ++i) {
        const glm::vec3 p = mesh.positions[t[i]];
        EXPECT_NEAR(p.x, (mesh.uvs[t[i]].x - 0.5F) * 3, 1e-6);
        EXPECT_NEAR(p.z, (0.5F - mesh.uvs[t[i]].y) * 2, 1e-6);
      }
      const glm::vec3 joint(0.5F * (1 - options.contrast) + 0.1F);
      if (mesh.colors[t[0]] != joint) tiles_area += glm::length(area_vector(mesh, t));
      lightest = std::max(lightest, mesh.colors[t[0]].x);
    }
    EXPECT_NEAR(tiles_area / 6.0, 0.9 * 0.9, 1e-4);  // what the joints leave
    EXPECT_GT(lightest, 0.6F);
    // No T-junctions: every edge inside the plane has a partner that runs the other way.
    const auto edges = directed_edges(mesh);
    for (const auto& [edge, count] : edges) {
      EXPECT_EQ(count, 1);
      const auto border = [](const Position& p) {
        return std::abs(std::abs(std::get<0>(p)) - 1.5F) < 1e-6F || std::abs(std::abs(std::get<2>(p)) - 1.0F) < 1e-6F;
      };
      EXPECT_TRUE(edges.contains({edge.second, edge.first}) || (border(edge.first) && border(edge.second)));
    }
  }
}

}  // namespace
}  // namespace pellucid
