#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/scene/scene.hpp"
#include "algorithms/scene/shapes/procedural.hpp"
#include "tests/algorithms/scene/folder_test.hpp"
#include "tests/expect_near.hpp"

namespace pellucid {
namespace {

class SceneVolumes : public test::FolderTest {
 protected:
  Scene load(std::string_view text) {
    return load_scene(
        write("v.toml", "title = \"t\"\n[views.front]\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n" + std::string(text))
            .string());
  }
};

using test::expect_near;

/// World coordinates of a point of the box.
glm::vec3 at(const Volume& volume, const glm::vec3& local) {
  return glm::vec3(volume.to_world * glm::vec4(local, 1));
}

constexpr std::string_view kLightSpace = R"(
[lights.fill]
kind = "point"
position = [9, 9, 9]
intensity = 1
[lights.lamp]
kind = "spot"
position = [1, 5, 2]
direction = [0, -3, 0]
inner_angle_deg = 30
outer_angle_deg = 45
intensity = 7
shadow = true
[volume]
kind = "constant"
light = "lamp"
voxels = [8, 6, 16]
near_m = 0.5
range_m = 2
extinction = 1
[parameters]
x = { default = 1, range = [-5, 5], doc = "d", drives = ["lights.lamp.position.x"] }
tilt = { default = 0, range = [-5, 5], doc = "d", drives = ["lights.lamp.direction.x"] }
angle = { default = 45, range = [31, 80], doc = "d", drives = ["lights.lamp.outer_angle_deg"] }
near = { default = 0.5, range = [0.01, 1.5], doc = "d", drives = ["volume.near_m"] }
size = { default = 8, range = [1, 32], doc = "d", drives = ["volume.voxels.x"] }
fill = { default = 9, range = [0, 9], doc = "d", drives = ["lights.fill.position.x"] }
)";

TEST_F(SceneVolumes, LightsCastShadowsWhenAsked) {
  const Scene scene = load(kLightSpace);
  EXPECT_FALSE(scene.lights[0].casts_shadow);
  EXPECT_TRUE(scene.lights[1].casts_shadow);
}

TEST_F(SceneVolumes, ABoxEnclosesItsLightsCone) {
  const Scene scene = load(kLightSpace);
  const Volume& volume = *scene.volume;
  EXPECT_EQ(volume.light, 1);
  expect_near(at(volume, {0.5F, 0.5F, 0}), {1, 4.5F, 2});
  expect_near(at(volume, {0.5F, 0.5F, 1}), {1, 3, 2});
  expect_near(at(volume, {0, 0, 1}), {-1, 3, 0});  // tan 45° at 2 m
  expect_near(at(volume, {1, 1, 0}), {3, 4.5F, 4});
  EXPECT_GT(glm::determinant(volume.to_world), 0.0F);
}

TEST_F(SceneVolumes, VoxelsOfALightsSpaceStoreItsFalloffOverTheSquaredDistance) {
  const Scene scene = load(kLightSpace);
  const Volume& volume = *scene.volume;
  const Light& light = scene.lights[1];
  ASSERT_EQ(volume.scattering.size(), 8U * 6U * 16U);
  const float cos_inner = std::cos(glm::radians(30.0F)), cos_outer = std::cos(glm::radians(45.0F));
  int lit = 0;
  for (int k = 0; k < 16; ++k) {
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 8; ++i) {
        const glm::vec3 from_light = at(volume, (glm::vec3(i, j, k) + 0.5F) / glm::vec3(volume.size)) - light.position;
        const float distance2 = glm::dot(from_light, from_light);
        const float cosine = glm::dot(from_light, light.direction) / std::sqrt(distance2);
        const float expected = glm::smoothstep(cos_outer, cos_inner, cosine) / distance2;
        ASSERT_NEAR(volume.scattering[static_cast<std::size_t>((k * 6 + j) * 8 + i)], expected, 2e-5F * (1 + expected));
        lit += expected > 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(lit, 100);
  EXPECT_LT(lit, 600);
}

TEST_F(SceneVolumes, TheBoxFollowsTheLightAndItsVoxelsStayAsTheyAre) {
  Scene scene = load(kLightSpace);
  Volume& volume = *scene.volume;
  const float value = volume.scattering[0];
  constexpr float kMark = 123;  // would be lost if the voxels were computed again
  volume.scattering[0] = kMark;
  volume.density[0] = kMark;
  scene.parameters().assign("x", 3.0, "scene");
  expect_near(at(volume, {0.5F, 0.5F, 0}), {3, 4.5F, 2});
  scene.parameters().assign("tilt", 4.0, "scene");  // (4, −3, 0) / 5
  expect_near(at(volume, {0.5F, 0.5F, 1}), {3 + 1.6F, 5 - 1.2F, 2});
  const glm::mat3 axes(volume.to_world);
  EXPECT_NEAR(glm::dot(axes[0], axes[2]), 0, 1e-5);
  EXPECT_NEAR(glm::dot(axes[1], axes[2]), 0, 1e-5);
  EXPECT_NEAR(glm::length(axes[0]), 4, 1e-5);
  scene.parameters().assign("fill", 1.0, "scene");
  EXPECT_EQ(volume.scattering[0], kMark);
  EXPECT_EQ(volume.density[0], kMark);

  // The cone is another matter.
  scene.parameters().assign("angle", 60.0, "scene");
  EXPECT_NE(volume.scattering[0], kMark);
  EXPECT_EQ(volume.density[0], kMark);
  EXPECT_NEAR(glm::length(glm::vec3(volume.to_world[0])), 4 * std::sqrt(3.0F), 1e-5);
  volume.scattering[0] = kMark;
  scene.parameters().assign("near", 1.0, "scene");
  EXPECT_NE(volume.scattering[0], kMark);
  scene.parameters().assign("size", std::int64_t{4}, "scene");
  EXPECT_EQ(volume.scattering.size(), 4U * 6U * 16U);
  EXPECT_EQ(volume.density.size(), 4U * 6U * 16U);
  for (const auto& [name, back] : {std::pair("angle", Value(45.0)), {"near", Value(0.5)}, {"size", Value(8L)}})
    scene.parameters().assign(name, back, "scene");
  EXPECT_EQ(volume.scattering[0], value);
}

TEST_F(SceneVolumes, ParametersTellWhatTheyCost) {
  Scene scene = load(kLightSpace);
  const auto when = [&](std::string_view name) {
    for (const ParameterInfo& info : scene.parameters().infos()) {
      if (info.name == name) return info.when;
    }
    ADD_FAILURE() << name;
    return Change::program;
  };
  EXPECT_EQ(when("x"), Change::uniform);
  EXPECT_EQ(when("tilt"), Change::uniform);
  EXPECT_EQ(when("angle"), Change::precompute);
  EXPECT_EQ(when("near"), Change::precompute);
  EXPECT_EQ(when("size"), Change::precompute);
}

TEST_F(SceneVolumes, TheBoxFollowsALightOnAPathWithoutJumps) {
  Scene scene = load(R"(
[lights.lamp]
kind = "spot"
position_path = { keyframes = [{ time_s = 0, value = [0, 5, 0] }, { time_s = 8, value = [4, 5, 0] }] }
direction_path = { keyframes = [{ time_s = 0, value = [-1, -1, 0.01] }, { time_s = 4, value = [1, -1, -0.01] },
                                { time_s = 8, value = [1, 1, 0.3] }] }
intensity = 1
[volume]
kind = "constant"
light = "lamp"
voxels = 4
range_m = 3
extinction = 1
)");
  glm::mat4 before = scene.volume->to_world;
  for (int i = 1; i <= 800; ++i) {
    scene.parameters().assign("time_s", 0.01 * i, "scene");
    const glm::mat4& now = scene.volume->to_world;
    for (int c = 0; c < 4; ++c)
      ASSERT_LT(glm::length(now[c] - before[c]), 0.06F) << "column " << c << " at " << 0.01 * i << " s";
    expect_near(glm::normalize(glm::vec3(now[2])), scene.lights[0].direction);
    before = now;
  }
  expect_near(scene.lights[0].direction, glm::normalize(glm::vec3(1, 1, 0.3F)));
}

TEST_F(SceneVolumes, ALightMayPointStraightUp) {
  const Scene scene = load(
      "[lights.lamp]\nkind = \"spot\"\nposition = [0, 0, 0]\ndirection = [0, 1, 0]\nintensity = 1\n[volume]\nkind = "
      "\"constant\"\nlight = \"lamp\"\nvoxels = 2\nrange_m = 3\nextinction = 1\n");
  expect_near(at(*scene.volume, {0.5F, 0.5F, 1}), {0, 3, 0});
  EXPECT_GT(glm::determinant(scene.volume->to_world), 0.0F);
}

TEST_F(SceneVolumes, TransferPoints) {
  Scene scene = load(R"(
[volume]
kind = "constant"
voxels = 2
center = [0, 0, 0]
size = 1
extinction = 2
[[volume.transfer]]
density = 0.25
extinction = 0
[[volume.transfer]]
density = 0.75
extinction = 3
albedo = [0.5, 0.25, 1]
[parameters]
top = { default = 0.75, range = [0, 1], doc = "d", drives = ["volume.transfer[1].density"] }
)");
  ASSERT_EQ(scene.volume->transfer.size(), 2U);
  EXPECT_EQ(scene.volume->transfer[0].density, 0.25F);
  EXPECT_EQ(scene.volume->transfer[0].extinction, 0.0F);
  expect_near(scene.volume->transfer[0].albedo, glm::vec3(1));
  EXPECT_EQ(scene.volume->transfer[1].extinction, 3.0F);
  expect_near(scene.volume->transfer[1].albedo, {0.5F, 0.25F, 1});
  scene.parameters().assign("top", 0.5, "scene");
  EXPECT_EQ(scene.volume->transfer[1].density, 0.5F);
  EXPECT_EQ(scene.parameters().infos()[0].when, Change::precompute);
  // A contradiction is refused, and the scene stays as it was.
  EXPECT_NE(test::message_of([&] { scene.parameters().assign("top", 0.25, "scene"); }).find("densities must rise"),
            std::string::npos);
  EXPECT_EQ(scene.volume->transfer.size(), 2U);
  EXPECT_EQ(scene.volume->transfer[1].density, 0.5F);
}

constexpr std::string_view kFile = "[volume]\nkind = \"file\"\nfile = \"v.nrrd\"\ncenter = [0, 1, 0]\nextinction = 1\n";

class SceneVolumeFiles : public SceneVolumes {
 protected:
  SceneVolumeFiles() {
    const unsigned char voxels[] = {10, 20, 30, 40, 50, 60, 70, 110};
    write("v.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nspacings: 0.5 1 0.25\nencoding: raw\n\n" +
                        std::string(reinterpret_cast<const char*>(voxels), sizeof voxels));
  }
};

TEST_F(SceneVolumeFiles, SpacingMakesTheBoxUnlessTheSceneDoes) {
  const Scene scene = load(kFile);
  const Volume& volume = *scene.volume;
  EXPECT_EQ(volume.size, glm::ivec3(2));
  EXPECT_EQ(volume.density[0], 0.0F);
  EXPECT_NEAR(volume.density[4], 0.4F, 1e-6);
  EXPECT_EQ(volume.density[7], 1.0F);
  EXPECT_EQ(volume.file_range, glm::vec2(10, 110));
  expect_near(at(volume, {0, 0, 0}), {-0.5F, 0, -0.25F});
  expect_near(at(volume, {1, 1, 1}), {0.5F, 2, 0.25F});
  expect_near(volume.voxel_spacing_m(), {0.5F, 1, 0.25F});

  const Scene fitted = load(std::string(kFile) + "fit_m = 4\nrange = [20, 60]\n");
  expect_near(at(*fitted.volume, {1, 1, 1}), {1, 3, 0.5F});
  EXPECT_EQ(fitted.volume->density[0], 0.0F);
  EXPECT_EQ(fitted.volume->density[3], 0.5F);
  EXPECT_EQ(fitted.volume->density[7], 1.0F);
  EXPECT_EQ(fitted.volume->file_range, glm::vec2(20, 60));
  const Scene sized = load(std::string(kFile) + "size = [1, 1, 3]\n");
  expect_near(at(*sized.volume, {1, 1, 1}), {0.5F, 1.5F, 1.5F});
}

TEST_F(SceneVolumeFiles, TheDataCountInTheHash) {
  const std::string before = load(kFile).content_hash();
  EXPECT_EQ(load(kFile).content_hash(), before);
  std::string text = content(file("v.nrrd"));
  text.back() = 1;
  write("v.nrrd", text);
  EXPECT_NE(load(kFile).content_hash(), before);
  write("d.raw", std::string("\1\2"));
  write("v.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 1 1\nencoding: raw\ndata file: d.raw\n\n");
  const std::string detached = load(kFile).content_hash();
  write("d.raw", std::string("\1\3"));
  EXPECT_NE(load(kFile).content_hash(), detached);
}

TEST_F(SceneVolumes, SmokeAndWaterTakeTheirKeys) {
  const auto box = [](std::string_view keys) {
    return "[volume]\nvoxels = [6, 5, 4]\ncenter = [0, 0, 0]\nsize = 1\nextinction = 1\n" + std::string(keys);
  };
  const Scene smoke =
      load(box("kind = \"smoke\"\nseed = 7\noctaves = 2\nfrequency = 5\ncontrast = 0.6\nswirl = 0.9\n"));
  EXPECT_EQ(smoke.volume->density, make_smoke_density({6, 5, 4}, {7, 2, 5.0F, 0.6F, 0.9F}));
  EXPECT_EQ(load(box("kind = \"smoke\"\n")).volume->density, make_smoke_density({6, 5, 4}, SmokeOptions{}));
  const Scene water = load(box(
      "kind = \"water\"\nseed = 7\noctaves = 3\nfrequency = 5\ncontrast = 0.6\ndepth_gradient = 0.5\nlevel = 0.7\nwave "
      "= 0.1\ndensity = 2\n"));
  std::vector<float> expected = make_water_density({6, 5, 4}, {7, 3, 5.0F, 0.6F, 0.5F, 0.7F, 0.1F});
  for (float& d : expected)
    d *= 2;
  EXPECT_EQ(water.volume->density, expected);
  EXPECT_EQ(load(box("kind = \"water\"\n")).volume->density, make_water_density({6, 5, 4}, WaterOptions{}));
}

}  // namespace
}  // namespace pellucid
