#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "algorithms/scene/images/image.hpp"
#include "algorithms/scene/scene.hpp"
#include "tests/algorithms/scene/folder_test.hpp"
#include "tests/expect_near.hpp"

namespace pellucid {
namespace {

class SceneLoading : public test::FolderTest {
 protected:
  Scene load(std::string_view text, std::string_view name = "s.toml") { return load_scene(write(name, text).string()); }
};

constexpr std::string_view kView = R"(title = "t"
[views.front]
eye = [0, 0, 5]
target = [0, 0, 0]
)";

std::string with(std::string_view text) {
  return std::string(kView) + std::string(text);
}

using test::expect_near;

TEST_F(SceneLoading, TheSmallestSceneIsAView) {
  const Scene scene = load(kView, "small.toml");
  EXPECT_EQ(scene.name, "small");
  EXPECT_EQ(scene.title, "t");
  ASSERT_EQ(scene.views.size(), 1U);
  EXPECT_EQ(scene.views[0].name, "front");
  EXPECT_EQ(scene.views[0].fov_y_deg, 45.0F);
  EXPECT_FALSE(scene.volume);
  EXPECT_TRUE(scene.instances.empty());
  EXPECT_EQ(scene.revision(), 1U);
}

TEST_F(SceneLoading, TextsAmbientAndViewsInTheOrderOfTheFile) {
  const Scene scene = load(R"(title = "Title"
description = "What it shows"
stand_in = "a bear for the Buddha"
ambient = 0.25
views.zulu = { eye = [1, 2, 3], target = [0, 0, 0], up = [0, 0, 1], fov_y_deg = 30, near_m = 0.5, far_m = 50 }
[views.alpha]
eye = [0, 1, 0]
target = [1, 1, 0]
)");
  EXPECT_EQ(scene.description, "What it shows");
  EXPECT_EQ(scene.stand_in, "a bear for the Buddha");
  expect_near(scene.ambient, glm::vec3(0.25F));
  ASSERT_EQ(scene.views.size(), 2U);
  EXPECT_EQ(scene.views[0].name, "zulu");
  EXPECT_EQ(scene.find_view("").name, "zulu");
  expect_near(scene.views[0].up, {0, 0, 1});
  EXPECT_EQ(scene.views[0].fov_y_deg, 30.0F);
  EXPECT_EQ(scene.views[0].near_m, 0.5F);
  EXPECT_EQ(scene.views[0].far_m, 50.0F);
}

TEST_F(SceneLoading, EveryShapeMaterialsAndInstances) {
  const Scene scene = load(with(R"(
[materials.red]
albedo = [0.8, 0.1, 0.1]
emission = 2
[meshes]
ball = { shape = "sphere", radius = 2, segments = 16 }
brick = { shape = "box", size = [1, 2, 3] }
floor = { shape = "plane", size = [4, 6], segments = 2 }
pillar = { shape = "cylinder", radius = 0.5, height = 3, segments = 12 }
hat = { shape = "cone", radius = 0.5, height = 3, segments = 12 }
ring = { shape = "torus", radius = 2, minor_radius = 0.5, segments = 24 }
pot = { shape = "teapot", scale = 1, subdivisions = 4 }
[instances.first]
mesh = "brick"
material = "red"
position = [1, 2, 3]
rotation_axis = [0, 1, 0]
rotation_deg = 90
scale = [2, 1, 1]
tint = 0.5
)"));
  ASSERT_EQ(scene.meshes.size(), 7U);
  for (const Mesh& mesh : scene.meshes) {
    EXPECT_FALSE(mesh.triangles.empty()) << mesh.name;
    EXPECT_EQ(mesh.normals.size(), mesh.positions.size()) << mesh.name;
  }
  const auto longest = [](const Mesh& mesh) {
    float length = 0;
    for (const glm::vec3& p : mesh.positions)
      length = std::max(length, glm::length(p));
    return length;
  };
  EXPECT_EQ(scene.meshes[0].name, "ball");
  EXPECT_NEAR(longest(scene.meshes[0]), 2, 1e-5);
  EXPECT_NEAR(longest(scene.meshes[1]), std::sqrt(14.0) / 2, 1e-5);
  EXPECT_NEAR(longest(scene.meshes[2]), std::sqrt(13.0), 1e-5);
  EXPECT_NEAR(longest(scene.meshes[5]), 2.5, 1e-5);
  ASSERT_EQ(scene.materials.size(), 1U);
  expect_near(scene.materials[0].albedo, {0.8F, 0.1F, 0.1F});
  expect_near(scene.materials[0].emission, glm::vec3(2));
  ASSERT_EQ(scene.instances.size(), 1U);
  const Instance& instance = scene.instances[0];
  EXPECT_EQ(scene.meshes[static_cast<std::size_t>(instance.mesh)].name, "brick");
  expect_near(instance.tint, glm::vec3(0.5F));
  // Scaled by 2 along x, then x turned to −z, then moved.
  expect_near(glm::vec3(instance.to_world * glm::vec4(1, 0, 0, 1)), {1, 2, 1});
  expect_near(glm::vec3(instance.to_world * glm::vec4(0, 0, 1, 1)), {2, 2, 3});
}

TEST_F(SceneLoading, Lights) {
  const Scene scene = load(with(R"(
[lights.sun]
kind = "directional"
azimuth_deg = 90
elevation_deg = 30
intensity = 3
[lights.lamp]
kind = "point"
position = [1, 2, 3]
intensity = [1, 2, 3]
[lights.cone]
kind = "spot"
position = [0, 5, 0]
direction = [0, -2, 0]
inner_angle_deg = 10
outer_angle_deg = 15
intensity = 1
)"));
  ASSERT_EQ(scene.lights.size(), 3U);
  EXPECT_EQ(scene.lights[0].kind, LightKind::directional);
  // From +x, 30° above the horizon.
  expect_near(scene.lights[0].direction, {-std::sqrt(0.75F), -0.5F, 0});
  expect_near(scene.lights[0].intensity, glm::vec3(3));
  EXPECT_EQ(scene.lights[1].kind, LightKind::point);
  expect_near(scene.lights[1].position, {1, 2, 3});
  EXPECT_EQ(scene.lights[2].kind, LightKind::spot);
  expect_near(scene.lights[2].direction, {0, -1, 0});
  EXPECT_EQ(scene.lights[2].inner_angle_deg, 10.0F);
  EXPECT_EQ(scene.lights[2].outer_angle_deg, 15.0F);
}

TEST_F(SceneLoading, AVolumeByCornersOrByItsCentre) {
  const Scene corners = load(with(R"(
[volume]
kind = "constant"
voxels = [2, 3, 4]
min = [-1, 0, 1]
max = [1, 4, 2]
extinction = 0.5
density = 0.25
albedo = [0.9, 0.8, 0.7]
emission = 0.1
)"));
  ASSERT_TRUE(corners.volume);
  const Volume& volume = *corners.volume;
  EXPECT_EQ(volume.size, glm::ivec3(2, 3, 4));
  EXPECT_EQ(volume.density, std::vector<float>(24, 0.25F));
  EXPECT_EQ(volume.extinction, 0.5F);
  expect_near(volume.albedo, {0.9F, 0.8F, 0.7F});
  expect_near(volume.emission, glm::vec3(0.1F));
  expect_near(glm::vec3(volume.to_world * glm::vec4(0, 0, 0, 1)), {-1, 0, 1});
  expect_near(glm::vec3(volume.to_world * glm::vec4(1, 1, 1, 1)), {1, 4, 2});

  const Scene centre = load(with(R"(
[volume]
kind = "ball"
voxels = 16
center = [1, 2, 3]
size = [2, 4, 6]
rotation_axis = [0, 1, 0]
rotation_deg = 90
extinction = 1
density = 2
)"));
  expect_near(glm::vec3(centre.volume->to_world * glm::vec4(0.5F, 0.5F, 0.5F, 1)), {1, 2, 3});
  expect_near(glm::vec3(centre.volume->to_world * glm::vec4(1, 0.5F, 0.5F, 1)), {1, 2, 2});
  EXPECT_EQ(*std::max_element(centre.volume->density.begin(), centre.volume->density.end()), 2.0F);
}

TEST_F(SceneLoading, FogAndForest) {
  const Scene scene = load(with(R"(
[forest]
extent = [30, 40]
trees = 20
clearing = [1, 1]
clearing_radius = 3
relief_m = 0.5
seed = 7
[volume]
kind = "fog"
voxels = 16
seed = 3
octaves = 2
frequency = 2
height_falloff = 1
contrast = 0.5
center = [0, 1, 0]
size = 4
extinction = 0.3
)"));
  EXPECT_GE(scene.instances.size(), 21U);
  for (const Instance& instance : scene.instances) {
    EXPECT_LT(static_cast<std::size_t>(instance.mesh), scene.meshes.size());
    EXPECT_LT(static_cast<std::size_t>(instance.material), scene.materials.size());
  }
  EXPECT_EQ(scene.volume->density.size(), 4096U);
  EXPECT_NE(scene.volume->density.front(), scene.volume->density.back());
}

TEST_F(SceneLoading, EnvironmentsFromAFileOrAGradient) {
  ImageFile sky;
  sky.image = Image(8, 4, 3);
  std::fill(sky.image.pixels.begin(), sky.image.pixels.end(), 1.5F);
  write_exr(file("sky.exr"), sky);
  const Scene image = load(with("[environment]\nimage = \"sky.exr\"\nscale = 2\n"));
  ASSERT_TRUE(image.environment.image);
  expect_near(image.environment.radiance({0, 1, 0}), glm::vec3(3));
  const Scene gradient = load(with("[environment]\nzenith = [1, 0, 0]\nhorizon = 0.5\nground = 0.1\n"));
  expect_near(gradient.environment.radiance({0, 1, 0}), {1, 0, 0});
  expect_near(gradient.environment.radiance({1, 0, 0}), glm::vec3(0.5F));
}

TEST_F(SceneLoading, AssetsComeFromTheChosenFolder) {
  ImageFile sky;
  sky.image = Image(2, 1, 3);
  std::filesystem::create_directories(file("store/environments"));
  write_exr(file("store/environments/sky.exr"), sky);
  const std::string text = with("[environment]\nimage = \"asset:environments/sky.exr\"\n");
  const char* before = std::getenv("PELLUCID_ASSETS");
  const std::string kept = before != nullptr ? before : "";
  ::setenv("PELLUCID_ASSETS", file("store").c_str(), 1);
  EXPECT_NO_THROW(load(text));
  ::setenv("PELLUCID_ASSETS", file("elsewhere").c_str(), 1);
  EXPECT_EQ(test::message_of([&] { load(text); }),
            file("s.toml").string() + ":6:9: asset 'environments/sky.exr' is missing (looked for '" +
                file("elsewhere/environments/sky.exr").string() + "'); get it with: ./bootstrap assets");
  EXPECT_EQ(test::message_of([&] { load(with("[environment]\nimage = \"asset:../sky.exr\"\n")); }),
            file("s.toml").string() + ":6:9: 'asset:../sky.exr' is not the name of an asset");
  if (before != nullptr)
    ::setenv("PELLUCID_ASSETS", kept.c_str(), 1);
  else
    ::unsetenv("PELLUCID_ASSETS");
}

TEST_F(SceneLoading, MotionFollowsTime) {
  Scene scene = load(R"(title = "t"
[views.front]
eye_path = { keyframes = [{ time_s = 0, value = [0, 0, 5] }, { time_s = 10, value = [0, 0, 15] }] }
target = [0, 0, 0]
[views.orbit]
eye = [0, 1, 4]
target = [0, 1, 0]
spin = { deg_per_s = 90 }
[materials.m]
[meshes.b]
shape = "box"
[instances.b]
mesh = "b"
material = "m"
spin = { axis = [0, 0, 1], deg_per_s = 45 }
position_path = { loop = true, interpolation = "catmull_rom", keyframes = [
  { time_s = 0, value = [0, 0, 0] }, { time_s = 1, value = [1, 0, 0] }, { time_s = 2, value = [0, 0, 0] }] }
[instances.still]
mesh = "b"
material = "m"
[lights.sun]
kind = "directional"
direction = [1, 0, 0]
intensity = 1
spin = { axis = [0, 0, 1], deg_per_s = 90 }
[lights.lamp]
kind = "point"
intensity = 1
position_path = { keyframes = [{ time_s = 0, value = [0, 0, 0] }, { time_s = 4, value = [0, 8, 0] }] }
[volume]
kind = "constant"
voxels = 2
center_path = { keyframes = [{ time_s = 0, value = [0, 0, 0] }, { time_s = 2, value = [2, 0, 0] }] }
size = 1
extinction = 1
)");
  expect_near(scene.instances[0].to_world[3], {0, 0, 0});
  scene.parameters().assign("time_s", 1.0, "scene");
  expect_near(scene.views[0].eye, {0, 0, 6});
  expect_near(scene.views[1].eye, {4, 1, 0});
  expect_near(scene.instances[0].to_world[3], {1, 0, 0});
  expect_near(scene.instances[0].to_world[0], {std::sqrt(0.5F), std::sqrt(0.5F), 0});
  expect_near(scene.lights[0].direction, {0, 1, 0});
  expect_near(scene.lights[1].position, {0, 2, 0});
  expect_near(glm::vec3(scene.volume->to_world * glm::vec4(0.5F, 0.5F, 0.5F, 1)), {1, 0, 0});
  EXPECT_EQ(scene.instances[1].to_world, glm::mat4(1.0F));
  scene.parameters().assign("time_s", 3.0, "scene");  // the loop is back at 1 s
  expect_near(scene.instances[0].to_world[3], {1, 0, 0});
}

TEST_F(SceneLoading, HashesFollowContentAndParameters) {
  const std::string text = with(
      "[environment]\nhorizon = 1\n[parameters]\nsky = { default = 1, range = [0, 2], doc = "
      "\"brightness\", drives = [\"environment.scale\"], mode = \"scale\" }\n");
  Scene scene = load(text);
  const std::string hash = scene.content_hash();
  EXPECT_EQ(hash.size(), 64U);
  EXPECT_EQ(load(text, "another_name.toml").content_hash(), hash);
  EXPECT_NE(load(text + "#\n").content_hash(), hash);
  scene.parameters().assign("sky", 0.5, "scene");
  EXPECT_NE(scene.content_hash(), hash);
  scene.parameters().assign("sky", 1.0, "scene");
  EXPECT_EQ(scene.content_hash(), hash);

  const std::string cube = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const std::string mesh = with("[meshes.m]\nfile = \"m.off\"\n");
  write("m.off", cube);
  const std::string first = load(mesh).content_hash();
  EXPECT_EQ(load(mesh).content_hash(), first);
  write("m.off", cube + "# other bytes\n");
  EXPECT_NE(load(mesh).content_hash(), first);
}

TEST_F(SceneLoading, AnUnknownNameIsSuggested) {
  EXPECT_EQ(test::message_of([&] { load_scene(file("none.toml").string()); }),
            "cannot read scene '" + file("none.toml").string() + "': No such file or directory");
  std::filesystem::create_directory(file("d.toml"));
  EXPECT_EQ(test::message_of([&] { load_scene(file("d.toml").string()); }),
            "cannot read scene '" + file("d.toml").string() + "': not a regular file");
  EXPECT_TRUE(test::message_of([] {
                load_scene("no_scene_is_called_so");
              }).starts_with("unknown scene 'no_scene_is_called_so'; there are "));
}

TEST(EmbeddedScenes, AllLoadAtTheEndsOfTheirParameters) {
  std::set<std::string> names;
  EXPECT_FALSE(list_scenes().empty());
  for (const SceneInfo& info : list_scenes()) {
    SCOPED_TRACE(info.name);
    EXPECT_TRUE(names.insert(info.name).second) << "two modules have a scene of this name";
    EXPECT_FALSE(info.title.empty());
    EXPECT_FALSE(info.module.empty());
    Scene scene;
    try {
      scene = load_scene(info.name);
    } catch (const InputError& error) {
      // A machine without the assets still has every procedural scene.
      ASSERT_NE(std::string(error.what()).find("./bootstrap assets"), std::string::npos) << error.what();
      continue;
    }
    EXPECT_EQ(scene.title, info.title);
    EXPECT_EQ(scene.description, info.description);
    EXPECT_FALSE(scene.views.empty());
    EXPECT_EQ(scene.content_hash(), load_scene(info.name).content_hash());
    for (const ParameterInfo& parameter : scene.parameters().infos()) {
      EXPECT_FALSE(parameter.doc.empty()) << parameter.name;
      const bool whole = parameter.type == ValueType::integer;
      for (const double end : {parameter.min, parameter.max}) {
        const Value value = whole ? Value(static_cast<std::int64_t>(end)) : Value(end);
        EXPECT_NO_THROW(scene.parameters().assign(parameter.name, value, "scene")) << parameter.name << " = " << end;
      }
      scene.parameters().assign(parameter.name, parameter.default_value, "scene");
    }
  }
}

TEST_F(SceneLoading, TheScenesOfEachFigureHaveAProceduralVariant) {
  const char* before = std::getenv("PELLUCID_ASSETS");
  const std::string kept = before != nullptr ? before : "";
  ::setenv("PELLUCID_ASSETS", folder_.path().c_str(), 1);
  for (const char* name : {"fog_forest", "water_tank_procedural", "teapot_room", "statue_spotlight_procedural"})
    EXPECT_FALSE(load_scene(name).stand_in.empty()) << name;
  if (before != nullptr) {
    ::setenv("PELLUCID_ASSETS", kept.c_str(), 1);
  } else {
    ::unsetenv("PELLUCID_ASSETS");
  }
}

}  // namespace
}  // namespace pellucid
