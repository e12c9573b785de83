// Height-mapped surfaces in scene files.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/reference/reference.hpp"
#include "algorithms/scene/images/image.hpp"
#include "algorithms/scene/scene.hpp"
#include "tests/algorithms/scene/folder_test.hpp"

namespace pellucid {
namespace {

constexpr std::string_view kReliefScene =
    "title = \"t\"\n[views.front]\neye = [0, 2, 2]\ntarget = [0, 0, 0]\n[materials.white]\nalbedo = 1\n"
    "[materials.mirror]\nkind = \"mirror\"\n[meshes.plane]\nshape = \"plane\"\n";

class SceneReliefs : public test::FolderTest {
 protected:
  Scene load(std::string_view text) {
    return load_scene(write("s.toml", std::string(kReliefScene) + std::string(text)).string());
  }
  /// Without file, line and column.
  std::string error_of(std::string_view text) {
    const std::string path = write("s.toml", std::string(kReliefScene) + std::string(text)).string();
    const std::string message = test::message_of([&] { load_scene(path); });
    EXPECT_TRUE(message.starts_with(path + ":")) << message;
    std::size_t at = path.size();
    for (int colon = 0; colon < 2; ++colon)
      at = message.find(':', at + 1);
    return message.substr(std::min(message.size(), at + 2));
  }
};

TEST_F(SceneReliefs, LayersAndOptics) {
  const Scene scene = load(R"([reliefs.wet]
tiling = [2, 3]
edges = "repeat"
[reliefs.wet.solid]
shape = "bricks"
texels = [32, 16]
low = -0.2
high = -0.1
albedo = [0.8, 0.4, 0.2]
[reliefs.wet.translucent]
shape = "waves"
low = -0.1
high = 0
index = 1.5
half_depth = [0.1, 0.2, 0.4]
[instances.ground]
mesh = "plane"
material = "white"
relief = "wet"
)");
  ASSERT_EQ(scene.reliefs.size(), 1U);
  const Relief& relief = scene.reliefs[0];
  EXPECT_EQ(scene.instances[0].relief, 0);
  EXPECT_TRUE(optical(scene, scene.instances[0]));
  EXPECT_TRUE(has_interfaces(scene));
  EXPECT_EQ(relief.tiling, glm::vec2(2, 3));
  EXPECT_FALSE(relief.cut);
  EXPECT_EQ(relief.solid.heights.width, 32);
  EXPECT_EQ(relief.solid.heights.height, 16);
  EXPECT_EQ(relief.solid.normals.channels, 2);
  EXPECT_EQ(relief.index, 1.5F);
  // Half of the light is left after the half-value depth.
  EXPECT_NEAR(std::exp(-static_cast<double>(relief.absorption.y) * 0.2), 0.5, 1e-6);
  EXPECT_EQ(relief.low_m(), -0.2F);
  EXPECT_EQ(relief.high_m(), 0.0F);
}

// Drops lie on the solid and nowhere else reach above it; rain is the same at the same time, and another later.
TEST_F(SceneReliefs, DropsAndRain) {
  Scene scene = load(R"([reliefs.wet.solid]
shape = "noise"
low = -0.2
high = -0.1
[reliefs.wet.translucent]
shape = "rain"
height = 0.05
)");
  const ReliefLayer dry = *scene.reliefs[0].translucent;
  EXPECT_LT(dry.low_m, -0.2F);
  EXPECT_LE(dry.high_m, 0.0F);
  const std::uint64_t revision = scene.reliefs[0].maps_revision;
  scene.parameters().assign("time_s", 5.0, "scene");
  EXPECT_GT(scene.reliefs[0].maps_revision, revision);
  const std::vector<float> later = scene.reliefs[0].translucent->heights.pixels;
  EXPECT_NE(later, dry.heights.pixels);
  scene.parameters().assign("time_s", 1.0, "scene");
  scene.parameters().assign("time_s", 5.0, "scene");
  EXPECT_EQ(scene.reliefs[0].translucent->heights.pixels, later);
}

TEST_F(SceneReliefs, MapsFromFiles) {
  Image one(1, 1, 3);
  one.pixels = {0.25F, 0.5F, 1.0F};
  write_png(file("one.png"), one);
  Image tilted(2, 2, 3);
  for (int i = 0; i < 4; ++i)
    std::copy_n(std::array{0.5F, 0.75F, 0.93F}.data(), 3, tilted.pixels.data() + 3 * i);
  write_png(file("tilted.png"), tilted);
  const std::string solid = "[reliefs.a.solid]\nfile = \"one.png\"\nnormals = \"tilted.png\"\n";
  const Scene up = load(solid), down = load(solid + "flip_green = true\n");
  EXPECT_NEAR(up.reliefs[0].solid.heights.pixels.at(0), 0.25, 2e-3);
  EXPECT_TRUE(up.reliefs[0].solid.normal_map);
  EXPECT_GT(up.reliefs[0].solid.normals.at(0, 0)[1], 0.3F);
  EXPECT_EQ(down.reliefs[0].solid.normals.at(0, 0)[1], -up.reliefs[0].solid.normals.at(0, 0)[1]);
  EXPECT_TRUE(error_of("[reliefs.a.solid]\nfile = \"one.png\"\nchannel = \"alpha\"\n")
                  .ends_with("it has 3 channels, and none is alpha"));
  Image sky(1, 1, 3);
  sky.pixels = {0.5F, 0.5F, 0.1F};
  write_png(file("sky.png"), sky);
  EXPECT_NE(error_of("[reliefs.a.solid]\nfile = \"one.png\"\nnormals = \"sky.png\"\n").find("no normal map"),
            std::string::npos);
}

// Two grey values that differ in the last of 16 bits.
TEST_F(SceneReliefs, HeightsOf16BitPngKeepTheirBits) {
  constexpr std::array<unsigned char, 70> kPng{
      0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00,
      0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x10, 0x00, 0x00, 0x00, 0x00, 0x81, 0xd9, 0xfc, 0x15, 0x00, 0x00, 0x00,
      0x0d, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x68, 0x30, 0x69, 0x30, 0x05, 0x00, 0x03, 0xd6, 0x01, 0x6a,
      0xf6, 0x25, 0x8a, 0xfb, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  write("deep.png", std::string(kPng.begin(), kPng.end()));
  const Image heights = load("[reliefs.a.solid]\nfile = \"deep.png\"\n").reliefs[0].solid.heights;
  ASSERT_EQ(heights.pixels.size(), 2U);
  EXPECT_NEAR(heights.pixels[0], 0x8034 / 65535.0, 1e-7);
  EXPECT_NEAR(heights.pixels[1] - heights.pixels[0], 1 / 65535.0, 1e-7);
}

TEST_F(SceneReliefs, MistakesAreNamed) {
  const std::string flat = "[reliefs.a.solid]\nshape = \"flat\"\n";
  EXPECT_EQ(error_of("[reliefs.a]\ntiling = [1, 1]\n"), "'solid' is missing in reliefs.a");
  EXPECT_EQ(error_of(flat + "low = 0\n"), "reliefs.a.solid: low 0 must be below high 0");
  EXPECT_EQ(error_of(flat + "[reliefs.a.translucent]\nshape = \"flat\"\nindex = 0\n"),
            "reliefs.a.translucent.index = 0 is out of range [0.2, 5]");
  EXPECT_EQ(error_of("[reliefs.a.solid]\nshape = \"drops\"\n"),
            "reliefs.a.solid.shape: drops lie on a solid: they are translucent");
  EXPECT_EQ(error_of(flat + "[instances.g]\nmesh = \"plane\"\nmaterial = \"white\"\nrelief = \"other\"\n"),
            "instances.g.relief: there is no relief 'other'; there are a");
  EXPECT_EQ(error_of(flat + "[instances.g]\nmesh = \"plane\"\nmaterial = \"mirror\"\nrelief = \"a\"\n"),
            "instances.g.relief: what lies on a relief is not a mirror, a metal or a dielectric: its material is "
            "lambertian");
  EXPECT_NE(error_of("[reliefs.a.solid]\nshape = \"flat\"\n[reliefs.a.translucent]\nshape = \"drops\"\nheight = 0.5\n")
                .find("its drops reach"),
            std::string::npos);
}

}  // namespace
}  // namespace pellucid
