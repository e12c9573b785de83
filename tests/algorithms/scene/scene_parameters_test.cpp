#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "algorithms/scene/scene.hpp"
#include "tests/algorithms/scene/folder_test.hpp"

namespace pellucid {
namespace {

class SceneParameters : public test::FolderTest {
 protected:
  Scene load(std::string_view parameters) {
    static constexpr std::string_view kScene = R"(title = "t"
[views.front]
eye = [0, 0, 5]
target = [0, 0, 0]
[materials.red]
albedo = [0.8, 0.1, 0.2]
[meshes.ball]
shape = "sphere"
segments = 8
[instances.ball]
mesh = "ball"
material = "red"
position = [1, 0, 0]
[forest]
trees = 5
extent = [20, 20]
[lights.sun]
kind = "directional"
azimuth_deg = 0
elevation_deg = 45
intensity = [1, 2, 3]
[volume]
kind = "ball"
voxels = 8
center = [0, 0, 0]
size = 1
extinction = 2
[environment]
horizon = 1
[parameters]
)";
    return load_scene(write("p.toml", std::string(kScene) + std::string(parameters)).string());
  }
};

TEST_F(SceneParameters, TimeIsBuiltIn) {
  Scene scene = load("");
  ASSERT_EQ(scene.parameters().infos().size(), 1U);
  const ParameterInfo& time = scene.parameters().infos()[0];
  EXPECT_EQ(time.name, "time_s");
  EXPECT_EQ(time.unit, "s");
  EXPECT_EQ(time.max, 3600);
  EXPECT_EQ(scene.parameters().get("time_s"), Value(0.0));
  Scene own = load("time_s = { default = 1, range = [0, 8] }\n");
  EXPECT_EQ(own.parameters().infos()[0].max, 8);
  EXPECT_EQ(own.parameters().get("time_s"), Value(1.0));
}

TEST_F(SceneParameters, MoveCubesPlacedByHand) {
  const auto text = [](const char* cubes) {
    return fmt::format(R"(title = "t"
[views.front]
eye = [0, 0, 5]
target = [0, 0, 0]
[materials.glass]
kind = "dielectric"
[meshes.star]
shape = "star"
lobes = 5
segments = 40
[instances.star]
mesh = "star"
material = "glass"
cubes = {}
[instances.other]
mesh = "star"
material = "glass"
[parameters]
x = {{ default = 0.25, range = [-1, 1], doc = "d", drives = ["instances.star.cubes[1].x"] }}
)",
                       cubes);
  };
  Scene scene = load_scene(write("c.toml", text("[[0.1, 0.2, 0.3], [0.25, -0.5, 0]]")).string());
  EXPECT_EQ(scene.instances[0].cubes, (std::vector<glm::vec3>{{0.1F, 0.2F, 0.3F}, {0.25F, -0.5F, 0.0F}}));
  EXPECT_TRUE(scene.instances[1].cubes.empty());
  const std::string before = scene.content_hash();
  scene.parameters().assign("x", -0.5, "scene c");
  EXPECT_EQ(scene.instances[0].cubes, (std::vector<glm::vec3>{{0.1F, 0.2F, 0.3F}, {-0.5F, -0.5F, 0.0F}}));
  EXPECT_NE(scene.content_hash(), before);
  scene.parameters().assign("x", 0.25, "scene c");
  EXPECT_EQ(scene.content_hash(), before);
  const Scene moved = load_scene(write("c.toml", text("[[0.1, 0.2, 0.4], [0.25, -0.5, 0]]")).string());
  EXPECT_NE(moved.content_hash(), before);
  try {
    load_scene(write("c.toml", text("[[0.1, 0.2, 0.3]]")).string());
    ADD_FAILURE() << "there is no second cube to drive";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("'instances.star.cubes[1].x' is nothing that can be driven"),
              std::string::npos)
        << e.what();
  }
}

TEST_F(SceneParameters, AreDescribed) {
  Scene scene = load(
      R"(thickness = { default = 2, range = [0, 9], symbol = "φ", unit = "1/m", cite = "Eq. 2", doc = "extinction", drives = ["volume.extinction"] }
seed = { default = 1, range = [0, 99], doc = "which forest", drives = ["forest.seed"] }
)");
  ASSERT_EQ(scene.parameters().infos().size(), 3U);
  const ParameterInfo& thickness = scene.parameters().infos()[0];
  EXPECT_EQ(thickness.name, "thickness");
  EXPECT_EQ(thickness.symbol, "φ");
  EXPECT_EQ(thickness.unit, "1/m");
  EXPECT_EQ(thickness.cite, "Eq. 2");
  EXPECT_EQ(thickness.doc, "extinction");
  EXPECT_EQ(thickness.type, ValueType::real);
  EXPECT_EQ(thickness.when, Change::uniform);
  EXPECT_EQ(thickness.min, 0);
  EXPECT_EQ(thickness.max, 9);
  EXPECT_EQ(thickness.default_value, Value(2.0));
  const ParameterInfo& seed = scene.parameters().infos()[1];
  EXPECT_EQ(seed.type, ValueType::integer);
  EXPECT_EQ(seed.when, Change::precompute);
  EXPECT_EQ(seed.default_value, Value(std::int64_t{1}));
}

TEST_F(SceneParameters, AColorIsThreeOfThem) {
  Scene scene = load(
      R"(paint = { default = [0.8, 0.1, 0.2], range = [0, 1], doc = "paint", drives = ["materials.red.albedo"] }
sun = { default = [1, 1, 1], range = [0, 2], mode = "scale", doc = "sun", drives = ["lights.sun.intensity"] }
)");
  ASSERT_EQ(scene.parameters().infos().size(), 7U);
  EXPECT_EQ(scene.parameters().infos()[1].name, "paint_green");
  EXPECT_EQ(scene.parameters().infos()[1].doc, "paint, green");
  EXPECT_EQ(scene.parameters().infos()[1].default_value, Value(0.1));
  scene.parameters().assign("paint_green", 0.5, "scene p");
  EXPECT_EQ(scene.materials[0].albedo, glm::vec3(0.8F, 0.5F, 0.2F));
  scene.parameters().assign("sun_blue", 0.5, "scene p");
  EXPECT_EQ(scene.lights[0].intensity, glm::vec3(1, 2, 1.5F));
}

TEST_F(SceneParameters, DriveOneNumberOrSeveral) {
  Scene scene = load(R"(phi = { default = 2, range = [0, 10], doc = "d", drives = ["volume.extinction"] }
factor = { default = 1, range = [0, 4], doc = "d", mode = "scale", drives = ["volume.extinction", "lights.sun.intensity"] }
more = { default = 0, range = [0, 5], doc = "d", mode = "add", drives = ["volume.extinction"] }
gray = { default = 1, range = [0, 1], doc = "d", mode = "scale", drives = ["materials.red.albedo"] }
x = { default = 1, range = [-5, 5], doc = "d", drives = ["instances.ball.position.x"] }
)");
  const auto assign = [&](const char* name, double value) { return scene.parameters().assign(name, value, "scene"); };
  EXPECT_EQ(assign("phi", 3), Change::uniform);
  EXPECT_EQ(scene.volume->extinction, 3.0F);
  assign("factor", 2);
  EXPECT_EQ(scene.volume->extinction, 6.0F);
  EXPECT_EQ(scene.lights[0].intensity, glm::vec3(2, 4, 6));
  assign("more", 1.5);
  EXPECT_EQ(scene.volume->extinction, 7.5F);
  assign("gray", 0.5);
  EXPECT_EQ(scene.materials[0].albedo, glm::vec3(0.4F, 0.05F, 0.1F));
  assign("x", -4);
  EXPECT_EQ(scene.instances[0].to_world[3], glm::vec4(-4, 0, 0, 1));
  EXPECT_EQ(scene.parameters().get("x"), Value(-4.0));
  // Back at the defaults the scene is the file's.
  for (const ParameterInfo& info : scene.parameters().infos()) {
    scene.parameters().assign(info.name, info.default_value, "scene");
  }
  EXPECT_EQ(scene.volume->extinction, 2.0F);
  EXPECT_EQ(scene.lights[0].intensity, glm::vec3(1, 2, 3));
  EXPECT_EQ(scene.instances[0].to_world[3], glm::vec4(1, 0, 0, 1));
}

TEST_F(SceneParameters, EvaluateOnlyWhatTheyDrive) {
  Scene scene = load(R"(phi = { default = 2, range = [0, 10], doc = "d", drives = ["volume.extinction"] }
trees = { default = 5, range = [0, 50], doc = "d", drives = ["forest.trees"] }
radius = { default = 1, range = [0.5, 2], doc = "d", drives = ["meshes.ball.radius"] }
)");
  const std::size_t few = scene.instances.size();
  const float* voxels = scene.volume->density.data();
  const glm::vec3* tree = scene.meshes.back().positions.data();
  const std::uint64_t revision = scene.revision();
  scene.parameters().assign("phi", 3.0, "scene");
  EXPECT_EQ(scene.volume->density.data(), voxels);
  EXPECT_EQ(scene.meshes.back().positions.data(), tree);
  EXPECT_EQ(scene.revision(), revision + 1);
  scene.parameters().assign("phi", 3.0, "scene");
  EXPECT_EQ(scene.revision(), revision + 1) << "nothing changed";
  EXPECT_EQ(scene.parameters().assign("trees", std::int64_t{40}, "scene"), Change::precompute);
  EXPECT_GT(scene.instances.size(), few);
  EXPECT_EQ(scene.instances[0].name, "ball");
  EXPECT_EQ(scene.volume->density.data(), voxels);
  scene.parameters().assign("radius", 2.0, "scene");
  EXPECT_NEAR(glm::length(scene.meshes[0].positions[0]), 2, 1e-5);
  scene.parameters().assign("trees", std::int64_t{5}, "scene");
  EXPECT_EQ(scene.instances.size(), few);
}

TEST_F(SceneParameters, FollowASceneThatMoves) {
  Scene first = load("phi = { default = 2, range = [0, 10], doc = \"d\", drives = [\"volume.extinction\"] }\n");
  Scene scene = std::move(first);
  scene.parameters().assign("phi", 4.0, "scene");
  EXPECT_EQ(scene.volume->extinction, 4.0F);
}

TEST_F(SceneParameters, RefuseWhatIsOutOfRangeUnknownOrOfAnotherType) {
  Scene scene = load("phi = { default = 2, range = [0, 10], doc = \"d\", drives = [\"volume.extinction\"] }\n");
  const auto message = [&](const char* name, const Value& value) {
    return test::message_of([&] { scene.parameters().assign(name, value, "scene"); });
  };
  EXPECT_EQ(message("phi", 11.0), "scene: phi = 11 is out of range [0, 10]");
  EXPECT_EQ(message("phj", 1.0), "unknown parameter 'phj' of scene; did you mean 'phi'?");
  EXPECT_THROW(scene.parameters().assign("phi", std::string("thick"), "scene"), InputError);
  EXPECT_EQ(scene.volume->extinction, 2.0F);
  EXPECT_EQ(scene.revision(), 1U);
}

TEST_F(SceneParameters, AContradictionLeavesTheSceneAsItWas) {
  Scene scene = load("near = { default = 0.1, range = [0.1, 2000], doc = \"d\", drives = [\"views.front.near_m\"] }\n");
  EXPECT_EQ(test::message_of([&] { scene.parameters().assign("near", 1500.0, "scene"); }),
            file("p.toml").string() + ":2:1: views.front: near_m 1500 must be below far_m 1000");
  EXPECT_EQ(scene.views[0].near_m, 0.1F);
  EXPECT_EQ(scene.parameters().get("near"), Value(0.1));
  EXPECT_EQ(scene.revision(), 1U);
}

TEST(SceneWithoutAFile, HasNoParameters) {
  Scene scene;
  EXPECT_TRUE(scene.parameters().infos().empty());
  EXPECT_EQ(scene.revision(), 0U);
}

}  // namespace
}  // namespace pellucid
