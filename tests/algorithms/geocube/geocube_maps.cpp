// Errors by pixel, cubes placed by hand, and the scene of a star.
#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "algorithms/scene/shapes/procedural.hpp"
#include "gl/error.hpp"
#include "tests/algorithms/rendered.hpp"

namespace pellucid {
namespace {

using test::Settings;

Scene map_scene(Mesh mesh) {
  ::setenv("PELLUCID_CACHE", "off", 1);
  Scene scene;
  scene.name = "glass";
  mesh.name = "glass";
  scene.meshes.push_back(std::move(mesh));
  scene.materials.push_back({.name = "glass", .kind = SurfaceKind::dielectric, .ior = 1.5F});
  scene.instances.push_back({.name = "glass"});
  scene.environment.zenith = {0.2F, 0.4F, 0.9F};
  scene.environment.horizon = {1.0F, 0.8F, 0.6F};
  scene.environment.ground = {0.1F, 0.15F, 0.05F};
  scene.views.push_back({.name = "front", .eye = {0.0F, 0.0F, 3.4F}, .target = glm::vec3(0.0F), .fov_y_deg = 60.0F});
  return scene;
}

Settings map_settings(const test::Values& values, int width = 120, int height = 90) {
  Settings s;
  s.technique = "geocube";
  s.width = width;
  s.height = height;
  s.values = {{"frame.format", "single"}, {"resolution", "32"}};
  s.values.insert(s.values.end(), values.begin(), values.end());
  return s;
}

struct Told {
  std::vector<NativeMap> maps;
  nlohmann::json errors = nlohmann::json::object();

  const NativeMap& map(const std::string& name) const {
    for (const NativeMap& m : maps) {
      if (m.name == name) return m;
    }
    throw std::logic_error("no map " + name);
  }
};

Told told(RenderSession& session) {
  gl::PassTimer timer;
  session.render(timer);
  Told out;
  out.maps = session.technique().native_maps();
  session.technique().native_errors(out.errors);
  return out;
}

Told told(Scene scene, const Settings& s) {
  RenderSession session = test::start(std::move(scene), s);
  return told(session);
}

TEST(GeocubeMaps, AreWhatTheStatisticsSummarise) {
  const Told t = told(map_scene(make_torus(0.8F, 0.3F, 48)), map_settings({{"cubes", "2"}, {"iterations", "4"}}));
  std::set<std::string> names;
  for (const NativeMap& map : t.maps) {
    names.insert(map.name);
    EXPECT_EQ(map.values.width, 120);
    EXPECT_EQ(map.values.height, 90);
    ASSERT_EQ(map.values.channels, 1);
    EXPECT_FALSE(map.doc.empty()) << map.name;
    double sum = 0, largest = 0;
    int count = 0;
    for (const float v : map.values.pixels) {
      if (!std::isfinite(v)) continue;
      sum += static_cast<double>(v);
      largest = std::max(largest, static_cast<double>(v));
      ++count;
    }
    ASSERT_GT(count, 300) << map.name;
    EXPECT_LT(count, 120 * 90 / 2) << map.name << ": the background has values";
    EXPECT_GT(largest, 0) << map.name;
    EXPECT_NEAR(t.errors.at(map.name + (map.unit.empty() ? "_share" : "_mean")).get<double>(), sum / count, 1e-12);
    if (!map.unit.empty()) {
      EXPECT_EQ(t.errors.at(map.name + "_max"), largest);
    }
    if (map.name == "exit_error") {
      EXPECT_EQ(t.errors.at("object_pixels"), count);
    }
  }
  EXPECT_EQ(names, (std::set<std::string>{"exit_error", "length_error", "exit_direction_error_deg", "steps", "early",
                                          "bounded"}));
}

TEST(GeocubeMaps, StandAsThePictureDoes) {
  // The ball lies left of the middle and above it.
  Scene scene = map_scene(make_sphere(0.5F, 64));
  scene.instances[0].to_world = glm::translate(glm::mat4(1.0F), {-0.9F, 0.6F, 0.0F});
  RenderSession session = test::start(std::move(scene), map_settings({{"cubes", "1"}, {"show", "length"}}));
  const Told t = told(session);
  const Image image = session.read_color();
  const Image& map = t.map("exit_error").values;
  int inside = 0, right_or_below = 0;
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      if (!std::isfinite(*map.at(x, y))) continue;
      ++inside;
      right_or_below += x >= map.width / 2 || y >= map.height / 2 ? 1 : 0;
      // A pixel drawn as the way's length is grey, the environment is not.
      EXPECT_EQ(image.at(x, y)[0], image.at(x, y)[2]) << x << ' ' << y;
    }
  }
  EXPECT_GT(inside, 300);
  EXPECT_EQ(right_or_below, 0);
}

TEST(GeocubeMaps, OfABallAreSmallEverywhere) {
  const Told t =
      told(map_scene(make_sphere(1.0F, 200)),
           map_settings({{"cubes", "1"}, {"placement", "middle"}, {"resolution", "64"}, {"iterations", "40"}}));
  EXPECT_LT(t.errors.at("exit_error_mean"), 5e-4);
  EXPECT_LT(t.errors.at("exit_error_max"), 0.01);
  EXPECT_LT(t.errors.at("length_error_q95"), 2e-3);
  EXPECT_LT(t.errors.at("exit_direction_error_deg_median"), 0.5);
  for (const char* none : {"early", "bounded"}) {
    for (const float v : t.map(none).values.pixels)
      ASSERT_FALSE(v > 0) << none;
  }
  for (const float v : t.map("steps").values.pixels)
    ASSERT_TRUE(!std::isfinite(v) || (v >= 1 && v <= 40));
}

TEST(GeocubeMaps, AreEmptyBeforeTheFirstFrameAndPromisedByWhoHasThem) {
  test::use_context();
  for (const TechniqueInfo& info : techniques())
    EXPECT_TRUE(info.make()->native_maps().empty()) << info.name;
  EXPECT_TRUE(find_technique("geocube").maps);
  EXPECT_FALSE(find_technique("front_refraction").maps);
}

TEST(GeocubeMaps, KeepTheBackgroundEmptyWhereNothingIsGlass) {
  Scene scene = map_scene(make_sphere(1.0F, 32));
  scene.materials[0].kind = SurfaceKind::mirror;
  const Told t = told(std::move(scene), map_settings({}));
  for (const NativeMap& map : t.maps) {
    for (const float v : map.values.pixels)
      ASSERT_FALSE(std::isfinite(v)) << map.name;
  }
  EXPECT_FALSE(t.errors.contains("exit_error_mean"));
}

// ---- cubes by hand ----

TEST(GeocubeByHand, TakesTheFirstOfTheScenesCubes) {
  Scene ring = map_scene(make_torus(0.8F, 0.3F, 48));
  ring.instances[0].cubes = {{0.8F, 0, 0}, {-0.4F, 0, 0.69F}, {-0.4F, 0, -0.69F}};
  RenderSession session = test::start(
      std::move(ring), map_settings({{"placement", "hand"}, {"cubes", "3"}, {"switches", "2"}, {"iterations", "40"}}));
  const Told three = told(session);
  EXPECT_EQ(three.errors.at("cubes_placed"), 3);
  session.assign_text("cubes", "1");
  session.prepare();
  const Told one = told(session);
  EXPECT_EQ(one.errors.at("cubes_placed"), 1);
  EXPECT_GT(one.errors.at("unseen_share"), three.errors.at("unseen_share"));
  EXPECT_GT(one.errors.at("exit_error_mean"), 2 * three.errors.at("exit_error_mean").get<double>());
  session.assign_text("cubes", "16");
  session.prepare();
  EXPECT_EQ(told(session).errors.at("cubes_placed"), 3) << "cubes says how many at most";
}

TEST(GeocubeByHand, FollowsAPlaceThatTheSceneMoves) {
  const Settings s = map_settings({{"placement", "hand"}});
  Scene scene = map_scene(make_star({}, 60));
  scene.instances[0].cubes = {{0.0F, 0.0F, 0.0F}};
  RenderSession session = test::start(std::move(scene), s);
  const Told before = told(session);
  session.scene().instances[0].cubes = {{0.5F, 0.0F, 0.0F}};
  const Told moved = told(session);
  EXPECT_NE(before.errors.at("exit_error_mean"), moved.errors.at("exit_error_mean"));
  Scene there = map_scene(make_star({}, 60));
  there.instances[0].cubes = {{0.5F, 0.0F, 0.0F}};
  EXPECT_EQ(told(std::move(there), s).errors.at("exit_error_mean"), moved.errors.at("exit_error_mean"));
}

TEST(GeocubeByHand, LiesInTheMeshsSpaceHoweverTheInstanceStands) {
  const Settings s = map_settings({{"placement", "hand"}});
  const auto scene = [](const glm::vec3& scale) {
    Scene out = map_scene(make_sphere(1.0F, 64));
    out.instances[0].cubes = {{0.9F, 0.0F, 0.0F}};
    out.instances[0].to_world =
        glm::scale(glm::rotate(glm::translate(glm::mat4(1.0F), {0.1F, 0, 0}), 0.7F, glm::vec3(0, 1, 0)), scale);
    return out;
  };
  // Inside by a tenth of the radius, whatever the scale; its distances must not be those of another place.
  for (const glm::vec3 scale : {glm::vec3(0.5F), glm::vec3(0.5F, 0.8F, 0.9F)})
    EXPECT_LT(told(scene(scale), s).errors.at("exit_error_mean"), 0.01) << scale.y;
}

TEST(GeocubeByHand, TellsWhatIsMissingOrMisplaced) {
  const auto message = [](std::vector<glm::vec3> cubes) {
    Scene scene = map_scene(make_sphere(1.0F, 32));
    scene.instances[0].name = "vase";
    scene.instances[0].cubes = std::move(cubes);
    try {
      told(std::move(scene), map_settings({{"placement", "hand"}}));
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(message({}),
            "geocube: placement = hand, but instance 'vase' has no cubes; the scene file gives them as cubes = "
            "[[x, y, z], …] in [instances.vase]");
  const std::string outside = message({{0, 0, 0}, {0, 1.5F, 0}});
  EXPECT_NE(outside.find("the centre of cube 2"), std::string::npos) << outside;
  EXPECT_NE(outside.find("outside mesh 'glass'"), std::string::npos) << outside;
  EXPECT_EQ(message({{0.2F, 0, 0}}), "");
}

// ---- the scene ----

TEST(GlassStar, IsSeenByOneCube) {
  for (const char* placement : {"middle", "hand", "automatic"}) {
    const Told t =
        told(load_scene("glass_star"),
             map_settings({{"cubes", "1"}, {"placement", placement}, {"resolution", "64"}, {"iterations", "20"}}));
    EXPECT_LT(t.errors.at("unseen_share"), 0.001) << placement;
    EXPECT_LT(t.errors.at("exit_error_mean"), 0.003) << placement;
    EXPECT_LT(t.errors.at("bounded_share"), 0.01) << placement;
    EXPECT_GT(t.errors.at("object_pixels"), 500) << placement;
  }
}

}  // namespace
}  // namespace pellucid
