// Caustics: where the photons' power ends.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "algorithms/distance_impostors/caustics.hpp"
#include "algorithms/distance_impostors/light_map_chart.hpp"
#include "algorithms/reference/photons/photons.hpp"
#include "algorithms/scene/shapes/procedural.hpp"
#include "tests/algorithms/rendered.hpp"

namespace pellucid {
namespace {

using test::Values;

// A ball in a closed box of planes, under a lamp.
Scene box_room(const Material& material) {
  Scene scene;
  scene.name = "box_room";
  scene.meshes = {make_plane({4, 4}, 1), make_sphere(0.5F, 128)};
  scene.materials = {{.name = "wall", .albedo = {0.8F, 0.6F, 0.4F}}, material};
  const auto wall = [&](const char* name, const glm::vec3& axis, float degrees, const glm::vec3& position) {
    glm::mat4 to_world = glm::translate(glm::mat4(1), position);
    if (degrees != 0) to_world = glm::rotate(to_world, glm::radians(degrees), axis);
    scene.instances.push_back({.name = name, .mesh = 0, .material = 0, .to_world = to_world});
  };
  wall("floor", {1, 0, 0}, 0, {0, -2, 0});
  wall("ceiling", {1, 0, 0}, 180, {0, 2, 0});
  wall("back", {1, 0, 0}, 90, {0, 0, -2});
  wall("front", {1, 0, 0}, -90, {0, 0, 2});
  wall("left", {0, 0, 1}, -90, {-2, 0, 0});
  wall("right", {0, 0, 1}, 90, {2, 0, 0});
  scene.instances.push_back({.name = "ball",
                             .mesh = 1,
                             .material = 1,
                             .to_world = glm::translate(glm::mat4(1), glm::vec3(0.2F, -0.9F, 0.1F))});
  scene.lights = {{.name = "lamp",
                   .kind = LightKind::point,
                   .position = {-0.6F, 1.6F, 0.3F},
                   .intensity = {20, 16, 12},
                   .casts_shadow = true}};
  scene.views = {{.name = "front",
                  .eye = {0.5F, 0.6F, 1.9F},
                  .target = {0.2F, -1.2F, 0},
                  .fov_y_deg = 70,
                  .near_m = 0.02F,
                  .far_m = 20}};
  return scene;
}
Material caustic_glass(float ior = 1.3F) {
  return {.name = "glass", .kind = SurfaceKind::dielectric, .ior = ior};
}
Material caustic_mirror() {
  return {.name = "mirror", .kind = SurfaceKind::mirror};
}

nlohmann::json errors_of(Scene scene, const Values& values) {
  RenderSession session = test::start(std::move(scene), {"distance_impostors", values, "", 48, 48});
  session.assign_text("caustics", "true");
  gl::PassTimer timer;
  session.render(timer);
  nlohmann::json errors = nlohmann::json::object();
  session.technique().native_errors(errors);
  EXPECT_EQ(test::not_finite(session.read_color()), 0);
  return errors;
}

TEST(Caustics, TheLightThatLandsAgreesWithPhotonTracing) {
  for (const Material& material : {caustic_glass(), caustic_glass(1.6F), caustic_mirror()}) {
    const nlohmann::json errors = errors_of(box_room(material), {{"cube_size", "256"}, {"caustic_size", "128"}});
    EXPECT_NEAR(errors.at("caustic_energy_ratio").get<double>(), 1, 0.02) << material.name << " " << material.ior;
    EXPECT_LT(errors.at("caustic_reference_standard_error_w").get<double>(),
              0.002 * errors.at("caustic_reference_w").get<double>());
  }
}

// Whatever kind of light sends it.
TEST(Caustics, DirectionalLightsAndSpotsSendAsMuch) {
  Scene spot = box_room(caustic_glass());
  spot.lights[0].kind = LightKind::spot;
  spot.lights[0].direction = glm::normalize(glm::vec3(0.5F, -2.5F, -0.1F));
  spot.lights[0].inner_angle_deg = 5;
  spot.lights[0].outer_angle_deg = 14;  // a part of the ball
  EXPECT_NEAR(errors_of(std::move(spot), {{"caustic_size", "128"}}).at("caustic_energy_ratio").get<double>(), 1, 0.02);
  Scene sun = box_room(caustic_glass());
  sun.instances.erase(sun.instances.begin() + 1);  // through the open ceiling
  sun.lights[0].kind = LightKind::directional;
  sun.lights[0].direction = glm::normalize(glm::vec3(0.2F, -1, 0.1F));
  EXPECT_NEAR(errors_of(std::move(sun), {{"caustic_size", "128"}}).at("caustic_energy_ratio").get<double>(), 1, 0.02);
}

TEST(Caustics, AnOccluderKeepsPhotonsFromTheObject) {
  Scene shaded = box_room(caustic_glass());
  // A plate half across the way of the light.
  shaded.meshes.push_back(make_plane({0.5F, 2}, 1));
  shaded.instances.insert(shaded.instances.begin(),
                          {.name = "plate",
                           .mesh = 2,
                           .material = 0,
                           .to_world = glm::translate(glm::mat4(1), glm::vec3(-0.5F, 0.3F, 0.2F))});
  const double open = errors_of(box_room(caustic_glass()), {}).at("caustic_landed_w").get<double>();
  const nlohmann::json errors = errors_of(std::move(shaded), {{"caustic_size", "128"}});
  EXPECT_LT(errors.at("caustic_landed_w").get<double>(), 0.8 * open);
  EXPECT_GT(errors.at("caustic_landed_w").get<double>(), 0.1 * open);
  EXPECT_NEAR(errors.at("caustic_energy_ratio").get<double>(), 1, 0.03);
}

// The caustics of a scene alone, without a frame around them.
struct Landed {
  local_cube_maps::DynamicObjects objects;
  distance_impostors::Caustics caustics;
};
std::unique_ptr<Landed> land(const Scene& scene, const distance_impostors::CausticSettings& settings) {
  using namespace distance_impostors;
  using namespace local_cube_maps;
  test::use_context();
  ForwardPass forward(scene);
  forward.update_shadows(scene, {});
  const MapSettings maps{.cube_size = 256};
  const LookupSettings lookup{.search = {8, Scheme::false_position, 64}};
  auto landed = std::make_unique<Landed>();
  landed->objects.prepare(scene, maps, lookup, "test");
  landed->caustics.prepare(scene, settings, maps, landed->objects);
  const auto due = landed->objects.due(scene, maps);
  landed->objects.draw_maps(scene, forward, maps, lookup, due);
  landed->caustics.update(scene, forward, landed->objects, maps, lookup, due);
  return landed;
}

TEST(Caustics, WidthAndResolutionDoNotChangeThePower) {
  const Scene scene = box_room(caustic_glass());
  const auto landed = [&](int map_size, int light_map_size, float sigma) {
    return land(scene, {.enabled = true, .map_size = map_size, .light_map_size = light_map_size, .sigma_texels = sigma})
        ->caustics.landed_w();
  };
  const double usual = landed(64, 256, 1);
  EXPECT_GT(usual, 0.1);
  for (const float sigma : {0.25F, 6.0F, 16.0F})
    EXPECT_NEAR(landed(64, 256, sigma) / usual, 1, 1e-3) << sigma;
  for (const int size : {32, 512})
    EXPECT_NEAR(landed(64, size, 1) / usual, 1, 1e-3) << size;
  EXPECT_NEAR(landed(32, 256, 1) / usual, 1, 0.03);
}

// The light maps' irradiance, times the area of a texel, is the power; and each wall gets what photon tracing gives it.
TEST(Caustics, EachReceiverGetsItsShare) {
  const Scene scene = box_room(caustic_glass());
  const auto landed = land(scene, {.enabled = true, .map_size = 256, .light_map_size = 128});
  const distance_impostors::Caustics& caustics = landed->caustics;
  const std::vector<float> texels = caustics.light_maps().read();
  PhotonOptions options;
  options.photons = 1U << 18U;
  const Photons reference = trace_photons(scene, {}, options);
  const std::size_t layer = 128 * 128 * 4;
  const double texel_area = 16.0 / (128 * 128);
  ASSERT_EQ(caustics.receivers().size(), 6U);
  for (std::size_t r = 0; r < 6; ++r) {
    double irradiance = 0, power = 0;
    for (std::size_t i = r * layer; i < (r + 1) * layer; i += 4) {
      irradiance += static_cast<double>(texels[i] + texels[i + 1] + texels[i + 2]) / 3;
      power += static_cast<double>(texels[i + 3]);
    }
    EXPECT_NEAR(irradiance * texel_area, power, 1e-3 * power + 1e-6);
    const glm::dvec3 truth = reference.on_instance[static_cast<std::size_t>(caustics.receivers()[r])].mean;
    const double expected = (truth.x + truth.y + truth.z) / 3;
    EXPECT_NEAR(power, expected, 0.02 * expected + 0.002 * (reference.sent.mean.x)) << r;
  }
}

// A lamp of no power, one in the object and one that touches it: nothing that is no number, and a warning.
TEST(Caustics, LampsThatHaveNoCausticLeaveNone) {
  Scene dark = box_room(caustic_glass());
  dark.lights[0].intensity = glm::vec3(0);
  EXPECT_EQ(errors_of(std::move(dark), {}).at("caustic_landed_w").get<double>(), 0);
  for (const float away : {0.0F, 0.3F, 0.505F}) {
    Scene scene = box_room(caustic_glass());
    scene.lights[0].position = glm::vec3(0.2F, -0.9F + away, 0.1F);
    const nlohmann::json errors = errors_of(std::move(scene), {});
    EXPECT_EQ(errors.at("caustic_landed_w").get<double>(), 0) << away;
    EXPECT_NE(errors.at("warnings").get<std::string>().find("'lamp' lies in 'ball'"), std::string::npos);
  }
  Scene bright = box_room(caustic_glass());
  bright.lights[0].casts_shadow = false;
  EXPECT_NE(errors_of(std::move(bright), {}).at("warnings").get<std::string>().find("no caustic"), std::string::npos);
}

TEST(Caustics, FollowTheLightAndTheObject) {
  test::use_context();
  RenderSession session = test::start(load_scene("glass_caustic"), {"distance_impostors", {}, "", 96, 96});
  for (const auto& [name, value] : Values{{"caustics", "true"}, {"cube_size", "64"}, {"caustic_refresh", "changed"}})
    session.assign_text(name, value);
  gl::PassTimer timer;
  session.render(timer);
  const Image before = session.read_color();
  session.render(timer);
  EXPECT_EQ(test::difference(before, session.read_color()).max, 0);  // nothing moved
  session.assign("scene.lamp_x", Value(0.9));
  session.render(timer);
  const Image moved = session.read_color();
  EXPECT_GT(test::difference(before, moved).mean, 0.01);
  session.assign("scene.lamp_x", Value(-1.3));
  session.render(timer);
  EXPECT_LT(test::difference(before, session.read_color()).max, 1e-3);
}

TEST(LightMapChart, KeepsSurfacesApart) {
  using distance_impostors::make_chart;
  EXPECT_EQ(make_chart(make_plane({2, 1}, 3), 256, 2)->part_count, 1);
  EXPECT_EQ(make_chart(make_sphere(1, 32), 256, 2)->part_count, 1);
  const Mesh box = make_box({1, 2, 3});
  const auto chart = make_chart(box, 256, 2);
  ASSERT_TRUE(chart);
  EXPECT_EQ(chart->part_count, 6);
  for (std::size_t i = 0; i < box.positions.size(); ++i) {
    for (std::size_t j = 0; j < box.positions.size(); ++j) {
      // Three to a row: vertices of different parts lie two margins apart.
      if (chart->parts[i] == chart->parts[j]) continue;
      const glm::vec2 apart = glm::abs(chart->places[i] - chart->places[j]);
      EXPECT_GE(std::max(apart.x, apart.y), 3.9F / 256);
    }
  }
  Mesh bare = make_plane({1, 1}, 1);
  bare.uvs.clear();
  EXPECT_FALSE(make_chart(bare, 256, 2));
  Mesh folded = make_plane({1, 1}, 4);
  for (glm::vec2& uv : folded.uvs)
    uv.x = std::abs(uv.x - 0.5F);
  EXPECT_FALSE(make_chart(folded, 256, 2));
}

}  // namespace
}  // namespace pellucid
