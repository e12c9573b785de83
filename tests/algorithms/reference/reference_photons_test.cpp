// Light through objects onto surfaces, against closed forms.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "algorithms/reference/photons/photon_map.hpp"
#include "algorithms/reference/photons/photons.hpp"
#include "algorithms/scene/noise.hpp"
#include "gl/error.hpp"
#include "tests/algorithms/reference/optical_scenes.hpp"

namespace pellucid {
namespace {

using namespace test;

constexpr double kIrradiance = 2.0;

Scene lit_from_above() {
  Scene scene;
  scene.lights.push_back({.name = "sun",
                          .direction = {0, -1, 0},
                          .intensity = glm::vec3(static_cast<float>(kIrradiance), 1.0F, 0.5F),
                          .casts_shadow = true});
  return scene;
}

PhotonOptions few(std::uint64_t photons = 1U << 16) {
  PhotonOptions options;
  options.photons = photons;
  return options;
}

// Parallel light on a glass ball above an endless floor: what comes down by reflection at the outside and by straight
// passage, integrated over the ball's disc.
double lens_power(double ior, int reflections) {
  constexpr int kSteps = 20000;
  double sum = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const double s = (k + 0.5) / kSteps;  // sin of the angle of incidence
    const double i = std::asin(s), r = std::asin(s / ior), f = fresnel_of_angles(i, 1.0 / ior);
    const auto down = [](double deviation) { return std::cos(deviation) > 0.0 ? 1.0 : 0.0; };
    double lands = f * down(kPi - 2.0 * i);
    for (int n = 0; n <= reflections; ++n)
      lands += (1 - f) * (1 - f) * std::pow(f, n) * down(2.0 * (i - r) + n * (kPi - 2.0 * r));
    sum += lands * 2.0 * kPi * s / kSteps;
  }
  return kIrradiance * sum;
}

TEST(Photons, ABallOfGlassSendsFresnelsShareDown) {
  for (const float ior : {1.3F, 2.0F}) {
    Scene scene = lit_from_above();
    const int floor = add(scene, make_plane({20000, 20000}, 1), matte(glm::vec3(1.0F)), at({0, -2, 0}));
    add(scene, make_sphere(1.0F, 256), glass(ior));
    for (const int reflections : {0, 6}) {
      PhotonOptions options = few();
      options.reflections = reflections;
      const Photons photons = trace_photons(scene, {}, options);
      const Power landed = photons.on_instance[static_cast<std::size_t>(floor)];
      const double expected = lens_power(static_cast<double>(ior), reflections);
      EXPECT_NEAR(photons.sent.mean.x, kIrradiance * kPi, 2e-3) << "but for the tessellation";
      EXPECT_NEAR(landed.mean.x, expected, 4 * landed.standard_error.x + 1e-3 * expected) << ior << " " << reflections;
      EXPECT_LT(landed.standard_error.x, 2e-3 * expected);
      EXPECT_NEAR(landed.mean.y, 0.5 * landed.mean.x, 1e-9);
      EXPECT_NEAR(photons.landed.mean.x, landed.mean.x, 1e-9) << "on nothing else";
    }
  }
}

TEST(Photons, NoPowerIsMadeOrLost) {
  Scene scene = lit_from_above();
  add(scene, make_plane({4, 4}, 1), matte(glm::vec3(1.0F)), at({0, -2, 0}));
  add(scene, make_torus(1.0F, 0.4F, 64), glass(1.5F), glm::rotate(glm::mat4(1.0F), 0.7F, {1, 0, 0.2F}));
  scene.lights.push_back({.name = "lamp",
                          .kind = LightKind::point,
                          .position = {0.3F, 3.0F, 1.0F},
                          .intensity = glm::vec3(3.0F),
                          .casts_shadow = true});
  const Photons photons = trace_photons(scene, {}, few());
  const glm::dvec3 balance = photons.landed.mean + photons.escaped.mean + photons.limited_share * photons.sent.mean;
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(balance[c], photons.sent.mean[c], 2e-3 * photons.sent.mean[c]);  // roulette
  EXPECT_LT(photons.limited_share, 0.01);
  EXPECT_EQ(photons.lost_share, 0.0);
  EXPECT_GT(photons.landed.mean.x, 0.1 * photons.sent.mean.x);
  EXPECT_GT(photons.escaped.mean.x, 0.1 * photons.sent.mean.x);
}

TEST(Photons, AMirrorThrowsItsPictureOntoAWall) {
  Scene scene = lit_from_above();
  // A unit mirror at 45° turns the light from −y to +x; the wall x = 3 faces it.
  add(scene, make_plane({1, 1}, 1), mirror(0.75F), glm::rotate(glm::mat4(1.0F), -glm::quarter_pi<float>(), {0, 0, 1}));
  const int wall = add(scene, make_plane({8, 8}, 2), matte(glm::vec3(0.5F)),
                       at({3, 0, 0}) * glm::rotate(glm::mat4(1.0F), glm::half_pi<float>(), {0, 0, 1}));
  Receiver window;
  window.name = "window";
  window.origin = {3, -1, -1};
  window.edge_u = {0, 0, 2};
  window.edge_v = {0, 2, 0};
  window.width = 8;
  window.height = 8;
  const Photons photons = trace_photons(scene, {window, receiver_of(scene, wall, 4, 4)}, few());
  const double expected = 0.75 * kIrradiance * std::sqrt(0.5);
  const LightMap& map = photons.maps[0];
  EXPECT_NEAR(map.total.mean.x, expected, 4 * map.total.standard_error.x + 1e-4);
  EXPECT_LT(map.total.standard_error.x, 2e-3 * expected);
  EXPECT_NEAR(photons.maps[1].total.mean.x, map.total.mean.x, 1e-9) << "all of it lies in the window";
  EXPECT_NEAR(map.texel_area_m2, 1.0 / 16, 1e-12);
  // It is 1 m wide (z) and √½ m high about the centre.
  for (int v = 0; v < 8; ++v) {
    for (int u = 0; u < 8; ++u) {
      const double y = -1 + 0.25 * v, z = -1 + 0.25 * u;
      const double high = std::max(0.0, std::min(y + 0.25, std::sqrt(0.125)) - std::max(y, -std::sqrt(0.125)));
      const double wide = std::max(0.0, std::min(z + 0.25, 0.5) - std::max(z, -0.5));
      const std::size_t texel = static_cast<std::size_t>(8 * v + u);
      EXPECT_NEAR(map.power_w[texel].x, 0.75 * kIrradiance * high * wide, 5 * map.standard_error_w[texel].x + 1e-6);
      EXPECT_NEAR(map.irradiance(u, v).x, 16 * map.power_w[texel].x, 1e-12);
    }
  }
}

TEST(Photons, PointsAndSpotsSendTheirSolidAngle) {
  Scene scene;
  add(scene, make_sphere(1.0F, 256), mirror());
  Light lamp{.name = "lamp",
             .kind = LightKind::point,
             .position = {0, 3, 0},
             .intensity = glm::vec3(5.0F),
             .casts_shadow = true};
  scene.lights = {lamp};
  const double cone = 2 * kPi * (1 - std::sqrt(8.0) / 3.0);
  EXPECT_NEAR(trace_photons(scene, {}, few()).sent.mean.x, 5 * cone, 1e-3 * cone);

  // A spot whose whole beam falls on the ball: I ∫ smoothstep dω.
  lamp.kind = LightKind::spot;
  lamp.direction = {0, -1, 0};
  lamp.inner_angle_deg = 5;
  lamp.outer_angle_deg = 15;
  scene.lights = {lamp};
  const double inner = std::cos(glm::radians(5.0)), outer = std::cos(glm::radians(15.0));
  const double beam = 2 * kPi * ((1 - inner) + 0.5 * (inner - outer));
  const Power sent = trace_photons(scene, {}, few()).sent;
  EXPECT_NEAR(sent.mean.x, 5 * beam, 4 * sent.standard_error.x + 1e-3 * beam);

  // From inside a ball of glass, head-on everywhere: all but the Fresnel orders get out, and nothing is absorbed.
  lamp.kind = LightKind::point;
  lamp.position = {0, 0, 0};
  scene.lights = {lamp};
  scene.materials[0] = glass(1.5F);
  const Photons inside = trace_photons(scene, {}, few());
  EXPECT_NEAR(inside.sent.mean.x, 20 * kPi, 1e-9);
  EXPECT_NEAR(inside.escaped.mean.x, 20 * kPi, 0.02);
}

TEST(Photons, OnlyLightThatReachesAnObjectFirstIsSent) {
  Scene scene = lit_from_above();
  add(scene, make_sphere(0.5F, 64), glass(1.5F));
  add(scene, make_plane({8, 8}, 1), matte(glm::vec3(1.0F)), at({0, -2, 0}));
  const double alone = trace_photons(scene, {}, few()).sent.mean.x;
  EXPECT_GT(alone, 1.0);
  add(scene, make_plane({2, 2}, 1), matte(glm::vec3(1.0F)), at({0, 2, 0}));
  EXPECT_EQ(trace_photons(scene, {}, few()).sent.mean.x, 0.0) << "a plate in between";
  scene.instances.pop_back();
  // A second ball right below is sent nothing of its own, but stands in the way.
  add(scene, make_sphere(0.5F, 64), mirror(), at({0, -1.2F, 0}));
  EXPECT_NEAR(trace_photons(scene, {}, few()).sent.mean.x, alone, 0.02);
  scene.lights[0].casts_shadow = false;
  EXPECT_EQ(trace_photons(scene, {}, few()).photons, 0U);
}

TEST(Photons, DependOnTheSeedButNotOnThreads) {
  Scene scene = lit_from_above();
  add(scene, make_teapot(0.5F, 4), glass(1.5F));
  const int floor = add(scene, make_plane({8, 8}, 1), matte(glm::vec3(1.0F)), at({0, -1, 0}));
  const std::vector<Receiver> receivers{receiver_of(scene, floor, 16, 16)};
  const Photons many = trace_photons(scene, receivers, few(), true);
  PhotonOptions other = few();
  other.seed = 2;
  EXPECT_NE(trace_photons(scene, receivers, other).landed.mean, many.landed.mean);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Photons single = trace_photons(scene, receivers, few(), true);
  EXPECT_EQ(many.maps[0].power_w, single.maps[0].power_w);
  EXPECT_EQ(many.landed.mean, single.landed.mean);
  ASSERT_EQ(many.deposits.size(), single.deposits.size());
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < many.deposits.size(); ++i) {
    EXPECT_EQ(many.deposits[i].position, single.deposits[i].position);
    sum += glm::dvec3(many.deposits[i].power_w);
  }
  EXPECT_NEAR(sum.x, many.landed.mean.x, 1e-5 * sum.x);
}

TEST(Photons, TheStandardErrorIsHonest) {
  Scene scene = lit_from_above();
  add(scene, make_box(glm::vec3(1.0F)), glass(1.4F),
      glm::rotate(glm::mat4(1.0F), 0.8F, glm::normalize(glm::vec3(1, 0.3F, 0.5F))));
  add(scene, make_plane({3, 3}, 1), matte(glm::vec3(1.0F)), at({0.4F, -2, 0}));
  double spread = 0.0, stated = 0.0, mean = 0.0;
  std::vector<double> values;
  for (std::uint32_t seed = 1; seed <= 24; ++seed) {
    PhotonOptions options = few(4096);
    options.seed = seed;
    const Power landed = trace_photons(scene, {}, options).landed;
    values.push_back(landed.mean.x);
    mean += landed.mean.x / 24;
    stated += landed.standard_error.x / 24;
  }
  for (const double value : values)
    spread += (value - mean) * (value - mean) / 23;
  EXPECT_LT(std::sqrt(spread), 1.8 * stated);
  EXPECT_GT(std::sqrt(spread), stated / 1.8);
}

// ---- receivers ----

TEST(Receivers, AreFlatWithEvenTextureCoordinates) {
  Scene scene;
  const int floor = add(scene, make_plane({4, 2}, 3), matte(glm::vec3(1.0F)), at({1, 2, 3}));
  const Receiver receiver = receiver_of(scene, floor, 10, 20);
  EXPECT_NEAR(glm::length(glm::cross(receiver.edge_u, receiver.edge_v)), 8.0, 1e-5);
  const glm::dvec3 middle = receiver.origin + 0.5 * (receiver.edge_u + receiver.edge_v);
  EXPECT_LT(glm::distance(middle, glm::dvec3(1, 2, 3)), 1e-5);
  EXPECT_EQ(receiver.instance, floor);
  const int ball = add(scene, make_sphere(1.0F, 16), matte(glm::vec3(1.0F)));
  EXPECT_THROW(receiver_of(scene, ball, 4, 4), InputError);
  scene.meshes[0].uvs[0] += 0.25F;
  EXPECT_THROW(receiver_of(scene, floor, 4, 4), InputError);
  scene.meshes[0].uvs.clear();
  EXPECT_THROW(receiver_of(scene, floor, 4, 4), InputError);
  Receiver bad;
  bad.edge_v = 2.0 * bad.edge_u;
  EXPECT_THROW(trace_photons(scene, {bad}, few()), InputError);
  bad = {};
  bad.width = 5000;
  EXPECT_THROW(trace_photons(scene, {bad}, few()), InputError);
}

// ---- the picture ----

TEST(PhotonMap, SpreadsAPhotonOverAPlaneWithoutLosingAny) {
  Random random(3);
  std::vector<Deposit> deposits;
  double power = 0.0;
  for (int k = 0; k < 300; ++k) {
    const float p = random.range(0.5F, 1.5F);
    power += static_cast<double>(p);
    deposits.push_back({{random.range(0.2F, 0.8F), 1.0F, random.range(0.2F, 0.8F)}, {0, 1, 0}, glm::vec3(p)});
  }
  deposits.push_back({{0.5F, 1.0F, 0.5F}, {0, -1, 0}, glm::vec3(100.0F)});  // on the other side
  deposits.push_back({{0.5F, 0.9F, 0.5F}, {0, 1, 0}, glm::vec3(100.0F)});   // on another plane
  const PhotonMap map(deposits, 0.05);
  constexpr int kGrid = 400;
  double sum = 0.0;
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j)
      sum += map.at({(i + 0.5) / kGrid, 1.0, (j + 0.5) / kGrid}, {0, 1, 0}).mean.x / (kGrid * kGrid);
  }
  EXPECT_NEAR(sum, power, 1e-3 * power);
}

TEST(Photons, CausticsShowInThePicture) {
  Scene scene = lit_from_above();
  add(scene, make_plane({1, 1}, 1), mirror(0.75F), glm::rotate(glm::mat4(1.0F), -glm::quarter_pi<float>(), {0, 0, 1}));
  add(scene, make_plane({8, 8}, 2), matte(glm::vec3(0.5F)),
      at({3, 0, 0}) * glm::rotate(glm::mat4(1.0F), glm::half_pi<float>(), {0, 0, 1}));
  SurfaceOptions options;
  options.caustics = true;
  options.photons = 1U << 18;
  options.caustic_radius_m = 0.05;
  const auto wall = [&](float y, float z) {
    const Camera camera = looking({1.0F, y, z}, {3.0F, y, z}, 1, 1.0F);
    const SurfaceLayer layer = trace_surfaces(scene, camera, options);
    EXPECT_GE(layer.statistics.photons_s, 0.0);
    return std::pair(pixel(layer.radiance, 0, 0).x, layer.statistics.caustic_standard_error_max);
  };
  const double expected = 0.5 / kPi * 0.75 * kIrradiance;
  const auto [inside, error] = wall(0.1F, 0.2F);
  EXPECT_NEAR(inside, expected, 4 * error);
  EXPECT_LT(error, 0.05 * expected);
  EXPECT_EQ(wall(1.0F, 0.2F).first, 0.0);
  options.caustics = false;
  EXPECT_EQ(wall(0.1F, 0.2F).first, 0.0);
}

}  // namespace
}  // namespace pellucid
