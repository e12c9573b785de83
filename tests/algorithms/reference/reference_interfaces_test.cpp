// Single rays at interfaces against closed forms.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/reference/interface_bend.hpp"
#include "algorithms/reference/interfaces.hpp"
#include "algorithms/shaders/optics.hpp"
#include "tests/algorithms/reference/optical_scenes.hpp"

namespace pellucid {
namespace {

using namespace test;

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// A unit sphere of one index, and rays along −z that pass its axis at a distance.
class SphereRays : public ::testing::TestWithParam<double> {
 protected:
  static Scene make(double ior) {
    Scene scene;
    add(scene, make_sphere(1.0F, 512), glass(static_cast<float>(ior)));
    return scene;
  }
  // To the side at an angle that runs neither through vertices nor along edges.
  static glm::dvec3 start(double off_axis) { return {off_axis * std::cos(0.7531), off_axis * std::sin(0.7531), 4.0}; }
};

TEST_P(SphereRays, DeflectionAndPathOfEveryOrder) {
  const double ior = static_cast<double>(static_cast<float>(GetParam()));
  const Scene scene = make(ior);
  const InterfaceTracer tracer(scene);
  const glm::dvec3 along(0, 0, -1);
  for (const double off_axis : {0.05, 0.3, 0.6, 0.85, 0.97}) {
    const double i = std::asin(off_axis), sine = off_axis / ior;
    const InterfaceHit entry = tracer.nearest(start(off_axis), along);
    ASSERT_TRUE(entry);
    EXPECT_TRUE(entry.front);
    EXPECT_NEAR(glm::length(entry.position), 1.0, 1e-4);
    EXPECT_LT(angle_between(entry.normal, entry.position), 1e-4);
    const InnerPath path = tracer.through(entry, along, 3);
    if (sine >= 1.0) {
      EXPECT_EQ(path.entry_reflected_share, 1.0);
      EXPECT_TRUE(path.vertices.empty());
      EXPECT_FALSE(tracer.refracted_at(entry, along));
      continue;
    }
    const double r = std::asin(sine);
    EXPECT_NEAR(angle_between(path.entering, along), std::abs(i - r), 2e-4) << "one interface";
    EXPECT_NEAR(path.entry_reflected_share, fresnel_of_angles(i, 1.0 / ior), 2e-3);
    ASSERT_EQ(path.vertices.size(), 4U);
    for (std::size_t k = 0; k < 4; ++k) {
      const InnerVertex& vertex = path.vertices[k];
      EXPECT_NEAR(vertex.path_m, static_cast<double>(k + 1) * 2.0 * std::cos(r), 3e-4 * static_cast<double>(k + 1));
      EXPECT_NEAR(vertex.reflected_share, fresnel_of_angles(i, 1.0 / ior), 3e-3) << "Stokes";
      ASSERT_TRUE(vertex.leaving) << "what enters a sphere gets out";
      // Descartes: 2(i − r) + k(π − 2r), folded to [0, π].
      const double deviation = 2.0 * (i - r) + static_cast<double>(k) * (kPi - 2.0 * r);
      EXPECT_NEAR(angle_between(*vertex.leaving, along), std::acos(std::cos(deviation)),
                  1e-3 * (1.0 + static_cast<double>(k)))
          << "off axis " << off_axis << ", order " << k;
    }
    EXPECT_EQ(path.first_exit(), &path.vertices.front());
  }
}

INSTANTIATE_TEST_SUITE_P(Indices, SphereRays, ::testing::Values(1.1, 1.5, 2.4, 0.75));

TEST(Interfaces, ASlabShiftsARayAndKeepsItsDirection) {
  Scene scene;
  const int slab = add(scene, make_box({8.0F, 0.5F, 8.0F}), glass(1.5F));
  const InterfaceTracer tracer(scene);
  for (const double degrees : {0.0, 20.0, 50.0, 80.0}) {
    const double i = glm::radians(degrees), r = std::asin(std::sin(i) / 1.5);
    const glm::dvec3 along(std::sin(i), -std::cos(i), 0.0);
    const InterfaceHit entry = tracer.nearest(glm::dvec3(0.111, 0.25, 0.073) - along, along);
    const InnerPath path = tracer.through(entry, along, 0);
    ASSERT_EQ(path.vertices.size(), 1U);
    const InnerVertex& exit = path.vertices[0];
    EXPECT_EQ(exit.hit.instance, slab);
    ASSERT_TRUE(exit.leaving);
    EXPECT_LT(angle_between(*exit.leaving, along), 1e-7);
    const glm::dvec3 shift = exit.hit.position - entry.position;
    EXPECT_NEAR(glm::length(shift - glm::dot(shift, along) * along), 0.5 * std::sin(i - r) / std::cos(r), 1e-7);
    EXPECT_NEAR(exit.path_m, 0.5 / std::cos(r), 1e-7);
    EXPECT_GT(glm::dot(exit.hit.normal, along), 0.0) << "outwards";
    EXPECT_FALSE(exit.hit.front);
  }
}

TEST(Interfaces, TheNextHitMayLeaveAnObjectOut) {
  Scene scene;
  const int ball = add(scene, make_torus(1.0F, 0.4F, 128), mirror());
  const int wall = add(scene, make_plane({50, 50}, 1), matte(glm::vec3(1.0F)), at({0, -3, 0}));
  const InterfaceTracer tracer(scene);
  // Down into the hole's side and across it.
  const glm::dvec3 origin(0.75, 2.0, 0.013), down(0, -1, 0);
  const InterfaceHit first = tracer.nearest(origin, down);
  ASSERT_EQ(first.instance, ball);
  const glm::dvec3 bounce = tracer.reflected_at(first, down);
  EXPECT_NEAR(glm::length(bounce), 1.0, 1e-12);
  EXPECT_LT(bounce.x, 0.0);
  // Cross-section of the tube: centre (1, 0), radius 0.4.
  const double sine = 0.25 / 0.4;
  EXPECT_NEAR(angle_between(bounce, down), kPi - 2.0 * std::asin(sine), 5e-3);
  const glm::dvec3 across = glm::normalize(glm::dvec3(-1.0, -0.3, 0.0));
  EXPECT_EQ(tracer.next(first, across).instance, ball) << "the far side of the ring";
  const InterfaceHit beyond = tracer.next(first, across, ball);
  ASSERT_EQ(beyond.instance, wall);
  EXPECT_NEAR(beyond.position.y, -3.0, 1e-9);
  EXPECT_NEAR(beyond.distance_m, glm::distance(beyond.position, first.position), 1e-9);
  EXPECT_EQ(tracer.nearest_without(origin, down, ball).instance, wall);
  EXPECT_FALSE(tracer.next(first, {0, 1, 0}));
  EXPECT_NEAR(tracer.diagonal_m(ball), std::sqrt(2 * 2.8 * 2.8 + 0.8 * 0.8), 1e-3);
}

TEST(Interfaces, PrimaryIsThePixelsRay) {
  Scene scene;
  add(scene, make_plane({50, 50}, 1), mirror());
  const Camera camera = looking({0.3F, 2.0F, 5.0F}, {0, 0, 0}, 9);
  const InterfaceTracer tracer(scene);
  const SurfaceLayer layer = trace_surfaces(scene, camera);
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 9; ++x) {
      const InterfaceHit hit = tracer.primary(camera, x, y);
      const double distance = layer.distance_m[static_cast<std::size_t>(9 * y + x)];
      if (std::isinf(distance))
        EXPECT_FALSE(hit);
      else
        EXPECT_NEAR(hit.distance_m, distance, 1e-12);
    }
  }
}

// A right-angled prism whose legs face −x and −y; the hypotenuse faces (1, 1).
Mesh prism() {
  Mesh mesh;
  mesh.name = "prism";
  const glm::vec3 o(0, 0, -2), x(1, 0, -2), y(0, 1, -2), z(0, 0, 4);
  const auto face = [&](const std::vector<glm::vec3>& corners) {
    const glm::vec3 normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    const auto first = static_cast<unsigned>(mesh.positions.size());
    for (const glm::vec3& corner : corners) {
      mesh.positions.push_back(corner);
      mesh.normals.push_back(normal);
    }
    for (unsigned i = 2; i < corners.size(); ++i)
      mesh.triangles.emplace_back(first, first + i - 1, first + i);
  };
  face({o, y, x});
  face({o + z, x + z, y + z});
  face({o, o + z, y + z, y});
  face({o, x, x + z, o + z});
  face({x, y, y + z, x + z});
  return mesh;
}

TEST(Interfaces, APrismReflectsTotallyBeyondTheCriticalAngle) {
  const glm::dvec3 along(1, 0, 0), origin(-1.0, 0.4, 0.1);
  for (const float ior : {1.5F, 1.3F}) {  // critical angles 41.8° and 50.3°; the hypotenuse is met at 45°
    Scene scene;
    add(scene, prism(), glass(ior));
    const InterfaceTracer tracer(scene);
    const InnerPath path = tracer.through(tracer.nearest(origin, along), along, 1);
    ASSERT_EQ(path.vertices.size(), 2U);
    EXPECT_NEAR(path.vertices[0].path_m, 0.6, 1e-6);
    EXPECT_NEAR(path.vertices[1].path_m, 1.0, 1e-6);
    ASSERT_TRUE(path.vertices[1].leaving);
    EXPECT_LT(angle_between(*path.vertices[1].leaving, {0, -1, 0}), 1e-6) << "by 90°";
    if (ior == 1.5F) {
      EXPECT_FALSE(path.vertices[0].leaving);
      EXPECT_EQ(path.vertices[0].reflected_share, 1.0);
      EXPECT_EQ(path.first_exit(), &path.vertices[1]);
    } else {
      ASSERT_TRUE(path.vertices[0].leaving);
      EXPECT_NEAR(path.vertices[0].reflected_share, fresnel_of_angles(kPi / 4, static_cast<double>(ior)), 1e-6);
      EXPECT_EQ(path.first_exit(), &path.vertices[0]);
    }
    EXPECT_EQ(tracer.inside(0, {0.2, 0.4, 0.1}, along, 1).vertices.size(), 2U);
    EXPECT_NEAR(tracer.inside(0, {0.2, 0.4, 0.1}, along, 1).vertices[0].path_m, 0.4, 1e-6);
  }
}

TEST(Interfaces, AnOpenMeshEndsThePath) {
  Scene scene;
  Mesh open = prism();
  open.triangles.resize(open.triangles.size() - 2);  // without the hypotenuse
  add(scene, open, glass(1.5F));
  const InterfaceTracer tracer(scene);
  const InnerPath path = tracer.through(tracer.nearest({-1.0, 0.4, 0.1}, {1, 0, 0}), {1, 0, 0}, 4);
  EXPECT_TRUE(path.vertices.empty());
  EXPECT_EQ(path.first_exit(), nullptr);
}

// ---- bent normals ----

TEST(BentNormals, KeepRaysOnTheirSidesAndSoundNormalsAsTheyAre) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return glm::normalize(glm::dvec3{normal(random), normal(random), normal(random)}); };
  int bent = 0;
  for (int k = 0; k < 20000; ++k) {
    const glm::dvec3 face = direction();
    glm::dvec3 along = direction(), shading = glm::normalize(face + 0.5 * direction());
    if (glm::dot(along, face) > 0.0) along = -along;
    if (glm::dot(shading, face) < 0.0) shading = -shading;
    if (k % 3 == 0) along = glm::normalize(along - 0.99 * glm::dot(along, face) * face);  // grazing
    const double eta = k % 2 == 0 ? 1.5 : 1.0 / 1.5;
    const Split split = split_at(along, shading, face, eta);
    ASSERT_LT(glm::dot(along, split.normal), 0.0);
    ASSERT_GT(glm::dot(split.reflected, face), 0.0);
    if (split.refracted) {
      ASSERT_LT(glm::dot(*split.refracted, face), 0.0);
      ASSERT_NEAR(glm::length(*split.refracted), 1.0, 1e-12);
    }
    ASSERT_EQ(split.refracted.has_value(), split.reflected_share < 1.0);
    const bool sound = glm::dot(along, shading) < 0.0 && glm::dot(reflected(along, shading), face) > 1e-3 &&
                       glm::dot(refracted(along, shading, eta).value_or(-face), face) < 0.0;
    if (sound)
      ASSERT_EQ(split.normal, shading);
    else
      ++bent;
    const Bend bend = reflect_at(along, shading, face);
    ASSERT_GT(glm::dot(bend.reflected, face), 0.0);
  }
  EXPECT_GT(bent, 1000);
}

TEST(BentNormals, AreContinuousInTheNormal) {
  const glm::dvec3 face(0, 0, 1), along = glm::normalize(glm::dvec3(1, 0, -0.1));
  glm::dvec3 before(0.0);
  double greatest = 0.0;
  for (int k = 0; k <= 10000; ++k) {  // from sound to far too steep
    const double tilt = -0.2 + 1.2 * k / 10000.0;
    const glm::dvec3 normal(std::sin(tilt), 0.0, std::cos(tilt));
    const glm::dvec3 now = reflect_at(along, normal, face).reflected;
    if (k > 0) greatest = std::max(greatest, glm::distance(now, before));
    before = now;
  }
  EXPECT_LT(greatest, 2.5 * 1.2 / 10000.0);
}

}  // namespace
}  // namespace pellucid
