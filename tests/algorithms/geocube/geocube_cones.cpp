#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/geocube/cones/triangle_distance.hpp"
#include "algorithms/geocube/cubes.hpp"
#include "tests/algorithms/geocube/geocube_solids.hpp"

namespace pellucid::geocube {
namespace {

using test::ellipsoid_radius;
using test::make_radial;
using test::random_direction;
using test::star_radius;

double widened(float v) {
  return static_cast<double>(v);
}

struct Shape {
  std::string name;
  Mesh mesh;
  std::function<double(const glm::dvec3&)> radius;  // about the origin
  glm::dvec3 center;
};

std::vector<Shape> shapes() {
  const glm::dvec3 axes(1.0, 0.6, 0.8);
  const auto box = [](const glm::dvec3& u) {
    const glm::dvec3 reach = glm::dvec3(0.8, 0.5, 1.0) / glm::abs(u);
    return std::min({reach.x, reach.y, reach.z});
  };
  return {{"sphere",
           make_radial([](const glm::dvec3&) { return 1.0; }, 32),
           [](const glm::dvec3&) { return 1.0; },
           {0.3, -0.2, 0.1}},
          {"ellipsoid",
           make_radial([axes](const glm::dvec3& u) { return ellipsoid_radius(u, axes); }, 32),
           [axes](const glm::dvec3& u) { return ellipsoid_radius(u, axes); },
           {0.2, 0.1, -0.3}},
          {"box", make_box({1.6F, 1.0F, 2.0F}), box, {0.1, 0.05, -0.2}},
          {"star", make_star({}, 168), star_radius, {0.05, 0.02, 0.1}}};
}

// How far a point lies outside, as a share of the radius there; negative inside.
double outside(const Shape& shape, const glm::dvec3& p) {
  const double length = glm::length(p);
  return length > 0 ? length / shape.radius(p / length) - 1 : -1;
}

TEST(GeocubeCones, EveryCellOfTheTreeMayBeLeftOutUnseen) {  // the full comparisons of the paper as twins
  for (const Shape& shape : shapes()) {
    const Solid solid(shape.mesh);
    CubeOptions options;
    options.resolution = 11;  // no power of two
    options.epsilon = 0.03;
    const CubeSet set = build_cubes(solid, std::vector{shape.center}, options);
    const CubeLayer& layer = set.cubes[0].layers[0];
    const CubeGrid grid = set.grid();
    const double half_width = 0.5 * options.epsilon * set.diagonal;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::uint32_t t = 0; t < solid.triangle_count(); ++t) {
      auto corners = solid.tree().corners(t);
      for (glm::dvec3& c : corners)
        c -= shape.center;
      nearest = std::min(nearest, distance_to_triangle(corners));
    }
    EXPECT_NEAR(widened(set.cubes[0].sphere), nearest, 1e-6);
    for (std::size_t i = 0; i < grid.texels(); i += 7) {
      const glm::dvec3 v = grid.direction(i);
      const auto hit = solid.first_hit(shape.center, v);
      ASSERT_TRUE(hit && hit->leaves);
      const glm::dvec3 s = hit->distance * v, normal = solid.shading_normal(hit->triangle, hit->weights);
      EXPECT_NEAR(widened(layer.bounds[i].x), hit->distance, 1e-6);
      EXPECT_LT(glm::distance(glm::dvec3(layer.planes[i]), normal), 1e-6);
      double a = 0, a_or_base = 0, b = -1, c = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < grid.texels(); ++k) {
        const glm::dvec3 point = widened(layer.bounds[k].x) * grid.direction(k), w = point - s;
        const double along = -glm::dot(w, v);
        // Single precision cannot tell on which side of the base a point beside it lies.
        if (k != i && along > 0 && along <= hit->distance * (1 - 1e-6)) a = std::max(a, along / glm::length(w));
        if (k != i && along > 0 && along <= hit->distance * (1 + 1e-6))
          a_or_base = std::max(a_or_base, along / glm::length(w));
        if (std::abs(glm::dot(w, normal)) > half_width * (1 + 1e-5)) b = std::max(b, glm::dot(grid.direction(k), v));
      }
      const double eta_sine = 1 / options.ior;
      // The tree of triangles has a test of its own to the last bit (geocube_bound_search.cpp); here some texels do.
      const bool all_triangles = i % 35 == 0;
      for (std::uint32_t t = 0; all_triangles && t < solid.triangle_count(); ++t) {
        if (t == hit->triangle) continue;
        c = std::min(c, distance_in_cone({shape.center + s, -normal, std::sqrt(1 - eta_sine * eta_sine), eta_sine},
                                         solid.tree().corners(t)));
      }
      EXPECT_GE(widened(layer.bounds[i].y), a - 2e-4) << shape.name << ' ' << i;
      EXPECT_LE(widened(layer.bounds[i].y), a_or_base + 2e-4) << shape.name << ' ' << i;
      EXPECT_NEAR(widened(layer.bounds[i].z), std::max(b, 0.0), 1e-5) << shape.name << ' ' << i;
      if (all_triangles) {
        EXPECT_NEAR(widened(layer.bounds[i].w), std::min(c, set.diagonal), 1e-6) << shape.name << ' ' << i;
      }
    }
  }
}

TEST(GeocubeCones, DistanceInAConeIsThatOfTheNearestPointInIt) {
  Random random(8);
  int met = 0;
  for (int i = 0; i < 300; ++i) {
    std::array<glm::dvec3, 3> t{};
    for (glm::dvec3& p : t)
      p = random_direction(random) * static_cast<double>(random.range(0.2F, 2.0F));
    const double angle = static_cast<double>(random.range(0.1F, 1.5F));
    const Cone cone{{0.1, 0.2, -0.1}, random_direction(random), std::cos(angle), std::sin(angle)};
    double least = std::numeric_limits<double>::infinity();
    constexpr int kFine = 300;
    for (int a = 0; a <= kFine; ++a) {
      for (int b = 0; a + b <= kFine; ++b) {
        const double u = static_cast<double>(a) / kFine, v = static_cast<double>(b) / kFine;
        const glm::dvec3 w = (1 - u - v) * t[0] + u * t[1] + v * t[2] - cone.apex;
        if (glm::dot(w, cone.axis) >= cone.cosine * glm::length(w)) least = std::min(least, glm::length(w));
      }
    }
    const double found = distance_in_cone(cone, t);
    EXPECT_LE(found, least + 1e-12);
    if (std::isfinite(least)) {
      ++met;
      EXPECT_GE(found, least - 0.1);  // the grid may miss the cone's edge on a flat slope
    }
  }
  EXPECT_GT(met, 60);
}

// Points of the four solids, drawn at random, stay inside to the size of a texel.
class InscribedCones : public ::testing::TestWithParam<int> {};

TEST_P(InscribedCones, LieInsideTheSolid) {
  const Shape shape = shapes()[static_cast<std::size_t>(GetParam())];
  const Solid solid(shape.mesh);
  CubeOptions options;
  options.resolution = 32;
  const CubeSet set = build_cubes(solid, std::vector{shape.center}, options);
  const CubeLayer& layer = set.cubes[0].layers[0];
  const CubeGrid grid = set.grid();
  const double texel = grid.texel_angle();
  const double epsilon = options.epsilon * set.diagonal;
  const double sine_c = 1 / options.ior, cosine_c = std::sqrt(1 - sine_c * sine_c);
  Random random(9);
  double worst = -1;
  for (std::size_t i = 0; i < grid.texels(); i += 5) {
    const glm::dvec3 v = grid.direction(i), normal(layer.planes[i]);
    const double d = widened(layer.bounds[i].x);
    const glm::dvec3 s = d * v;
    for (int k = 0; k < 20; ++k) {
      const glm::dvec3 across = glm::normalize(glm::cross(v, random_direction(random)));
      // Cone A: apex S, base at O.
      const double cos_a = widened(layer.bounds[i].y), along = d * static_cast<double>(random.next());
      const double tan_a = std::sqrt(1 - cos_a * cos_a) / std::max(cos_a, 0.05);
      const glm::dvec3 in_a = s - along * v + along * tan_a * across;
      EXPECT_LT(outside(shape, shape.center + in_a), texel) << shape.name << " A " << i;
      // Cone B: apex O, base in the tangent plane; the surface is within ε/2 of it.
      const double cos_b = widened(layer.bounds[i].z), sin_b = std::sqrt(1 - cos_b * cos_b);
      const double open = std::max(0.0, std::acos(cos_b) - texel);
      const glm::dvec3 direction = std::cos(open) * v + std::sin(open) * across;
      const double facing = glm::dot(direction, normal);
      EXPECT_GT(facing + (sin_b < texel ? 1 : 0), 0) << shape.name << " B " << i;
      if (facing > 0) {
        const glm::dvec3 in_b = glm::dot(s, normal) / facing * direction;
        EXPECT_LT(outside(shape, shape.center + in_b), (0.5 * epsilon / std::max(facing, 0.2) + texel * d) / 0.4)
            << shape.name << " B " << i;
      }
      // Cone C: apex S about the inner normal.
      const glm::dvec3 aside = glm::normalize(glm::cross(normal, random_direction(random)));
      const glm::dvec3 in_c = s + widened(layer.bounds[i].w) * (-cosine_c * normal + sine_c * aside);
      EXPECT_LT(outside(shape, shape.center + in_c), 0.5 * texel) << shape.name << " C " << i;
      // Sphere D.
      const glm::dvec3 in_d = widened(set.cubes[0].sphere) * random_direction(random);
      EXPECT_LT(outside(shape, shape.center + in_d), 1e-3) << shape.name;
      worst = std::max(worst, outside(shape, shape.center + in_a));
    }
  }
  EXPECT_GT(worst, -0.3) << "cones that touch nothing are too narrow";
}
INSTANTIATE_TEST_SUITE_P(Shapes, InscribedCones, ::testing::Range(0, 4),
                         [](const auto& p) { return shapes()[static_cast<std::size_t>(p.param)].name; });

TEST(GeocubeCones, EachIsLeftOutByItsOwnSwitch) {
  const Shape shape = shapes()[1];
  const Solid solid(shape.mesh);
  CubeOptions options;
  options.resolution = 8;
  options.use_a = options.use_b = options.use_c = options.use_d = false;
  const CubeSet none = build_cubes(solid, std::vector{shape.center}, options);
  EXPECT_EQ(none.cubes[0].sphere, 0.0F);
  for (const glm::vec4& b : none.cubes[0].layers[0].bounds) {
    EXPECT_EQ(glm::vec3(b.y, b.z, b.w), glm::vec3(1, 1, 0));
  }
  options = {.resolution = 8};
  const CubeSet inscribed = build_cubes(solid, std::vector{shape.center}, options);
  options.cone_b = ConeBase::enclosing;
  const CubeSet enclosing = build_cubes(solid, std::vector{shape.center}, options);
  for (std::size_t i = 0; i < none.grid().texels(); ++i) {
    const auto &b = inscribed.cubes[0].layers[0].bounds[i], &e = enclosing.cubes[0].layers[0].bounds[i];
    EXPECT_LT(b.y, 1.0F);
    EXPECT_GT(b.w, 0.0F);
    EXPECT_LE(e.w, b.w + 1e-6F);
  }
}

TEST(GeocubeCones, AFlatFaceGivesWideEnclosingCones) {
  const Solid solid(make_box(glm::vec3(2.0F)));
  CubeOptions options;
  options.resolution = 32;
  options.cone_b = ConeBase::enclosing;
  const CubeSet set = build_cubes(solid, std::vector{glm::dvec3(0.0)}, options);
  options.cone_b = ConeBase::inscribed;
  const CubeSet narrow = build_cubes(solid, std::vector{glm::dvec3(0.0)}, options);
  // At the face's middle the nearest edge is 45° away, the farthest corner 54.7°.
  const std::size_t middle = set.grid().index({0, 16, 16});
  EXPECT_NEAR(std::acos(widened(set.cubes[0].layers[0].bounds[middle].z)), std::acos(1 / std::sqrt(3.0)), 0.08);
  EXPECT_NEAR(std::acos(widened(narrow.cubes[0].layers[0].bounds[middle].z)), std::numbers::pi / 4, 0.05);
}

}  // namespace
}  // namespace pellucid::geocube
