// Mirrors, metals and dielectrics in scene files.
#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "algorithms/reference/reference.hpp"
#include "algorithms/scene/scene.hpp"
#include "tests/algorithms/scene/folder_test.hpp"

namespace pellucid {
namespace {

constexpr std::string_view kScene = "title = \"t\"\n[views.front]\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n";

class SceneMaterials : public test::FolderTest {
 protected:
  Scene load(std::string_view text) {
    return load_scene(write("s.toml", std::string(kScene) + std::string(text)).string());
  }
  std::string error_of(std::string_view text) {
    const std::string path = write("s.toml", std::string(kScene) + std::string(text)).string();
    const std::string message = test::message_of([&] { load_scene(path); });
    EXPECT_TRUE(message.starts_with(path + ":")) << message;
    return message.substr(std::min(message.size(), path.size() + 1));
  }
};

TEST_F(SceneMaterials, EachKindHasItsOwnKeys) {
  const Scene scene = load(R"([materials.glass]
kind = "dielectric"
ior = 1.33
absorption = [0, 0.5, 2]
[materials.plain_glass]
kind = "dielectric"
[materials.mirror]
kind = "mirror"
reflectance = 0.9
[materials.gold]
kind = "metal"
n = [0.2, 0.4, 1.4]
k = [3.6, 2.6, 1.9]
[materials.paint]
kind = "lambertian"
albedo = [0.1, 0.2, 0.3]
)");
  ASSERT_EQ(scene.materials.size(), 5U);
  const auto find = [&](std::string_view name) -> const Material& {
    for (const Material& material : scene.materials) {
      if (material.name == name) return material;
    }
    throw std::logic_error("no such material");
  };
  EXPECT_EQ(find("glass").kind, SurfaceKind::dielectric);
  EXPECT_EQ(find("glass").ior, 1.33F);
  EXPECT_EQ(find("glass").absorption, glm::vec3(0.0F, 0.5F, 2.0F));
  EXPECT_EQ(find("plain_glass").ior, 1.5F);
  EXPECT_EQ(find("plain_glass").absorption, glm::vec3(0.0F));
  EXPECT_EQ(find("mirror").kind, SurfaceKind::mirror);
  EXPECT_EQ(find("mirror").reflectance, glm::vec3(0.9F));
  EXPECT_EQ(find("gold").kind, SurfaceKind::metal);
  EXPECT_EQ(find("gold").metal_n, glm::vec3(0.2F, 0.4F, 1.4F));
  EXPECT_EQ(find("gold").metal_k, glm::vec3(3.6F, 2.6F, 1.9F));
  EXPECT_EQ(find("gold").reflectance, glm::vec3(1.0F));
  EXPECT_FALSE(find("paint").optical());
  for (const char* name : {"glass", "mirror", "gold"})
    EXPECT_TRUE(find(name).optical()) << name;
  EXPECT_FALSE(has_interfaces(scene)) << "no instance is made of them";
}

TEST_F(SceneMaterials, TheirNumbersAreParameters) {
  Scene scene = load(R"([meshes.ball]
shape = "sphere"
[materials.glass]
kind = "dielectric"
ior = 1.5
absorption = [1, 2, 3]
[instances.ball]
mesh = "ball"
material = "glass"
[parameters]
eta = { default = 1.5, range = [1, 3], doc = "index", mode = "set", drives = ["materials.glass.ior"] }
dye = { default = 1, range = [0, 10], doc = "dye", mode = "scale", drives = ["materials.glass.absorption"] }
)");
  EXPECT_TRUE(has_interfaces(scene));
  const std::string before = scene.content_hash();
  scene.parameters().assign("eta", 2.0, "scene");
  scene.parameters().assign("dye", 0.5, "scene");
  EXPECT_EQ(scene.materials[0].ior, 2.0F);
  EXPECT_EQ(scene.materials[0].absorption, glm::vec3(0.5F, 1.0F, 1.5F));
  EXPECT_NE(scene.content_hash(), before);
}

TEST_F(SceneMaterials, ErrorsNamePlaceAndReason) {
  const std::pair<std::string_view, std::string_view> cases[] = {
      {"[materials.m]\nkind = \"glas\"\n",
       "6:8: materials.m.kind = 'glas' is not one of lambertian, mirror, metal, dielectric"},
      {"[materials.m]\nkind = \"dielectrik\"\n",
       "6:8: materials.m.kind = 'dielectrik' is not one of lambertian, mirror, metal, dielectric; did you mean "
       "'dielectric'?"},
      {"[materials.m]\nkind = 3\n", "6:8: materials.m.kind must be a string, not an integer"},
      {"[materials.m]\nkind = \"dielectric\"\nior = 0.1\n", "7:7: materials.m.ior = 0.1 is out of range [0.2, 5]"},
      {"[materials.m]\nkind = \"dielectric\"\nior = [1, 1, 1]\n", "7:7: materials.m.ior must be a number, not a list"},
      {"[materials.m]\nkind = \"dielectric\"\nabsorption = -1\n", "7:14: materials.m.absorption = -1 is out of range"},
      {"[materials.m]\nkind = \"dielectric\"\nalbedo = 0.5\n",
       "7:1: unknown key 'albedo' in materials.m; known are kind, ior, absorption, scattering, anisotropy"},
      {"[materials.m]\nkind = \"mirror\"\nreflectance = 1.5\n",
       "7:15: materials.m.reflectance = 1.5 is out of range [0, 1]"},
      {"[materials.m]\nkind = \"mirror\"\nior = 1.5\n",
       "7:1: unknown key 'ior' in materials.m; known are kind, reflectance"},
      {"[materials.m]\nkind = \"metal\"\nk = 3\n", "5:1: 'n' is missing in materials.m"},
      {"[materials.m]\nkind = \"metal\"\nn = 1\n", "5:1: 'k' is missing in materials.m"},
      {"[materials.m]\nkind = \"metal\"\nn = [1, 0, 1]\nk = 3\n",
       "7:9: materials.m.n.g = 0 is out of range [0.01, 20]"},
      {"[materials.m]\nkind = \"metal\"\nn = 1\nk = 51\n", "8:5: materials.m.k = 51 is out of range [0, 50]"},
      {"[materials.m]\nior = 1.5\n", "6:1: unknown key 'ior' in materials.m; known are kind, albedo, emission"},
  };
  for (const auto& [text, message] : cases)
    EXPECT_TRUE(error_of(text).starts_with(message)) << error_of(text) << "\nwanted " << message;
}

}  // namespace
}  // namespace pellucid
