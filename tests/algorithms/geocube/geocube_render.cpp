#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "algorithms/reference/reference.hpp"
#include "gl/error.hpp"
#include "tests/algorithms/geocube/geocube_solids.hpp"
#include "tests/algorithms/rendered.hpp"

namespace pellucid {
namespace {

using test::difference;
using test::frame;
using test::not_finite;
using test::Settings;

Scene glass_scene(Mesh mesh, const glm::vec3& scale = glm::vec3(1.0F)) {
  ::setenv("PELLUCID_CACHE", "off", 1);
  Scene scene;
  scene.name = "glass";
  mesh.name = "glass";
  scene.meshes.push_back(std::move(mesh));
  scene.materials.push_back(
      {.name = "glass", .kind = SurfaceKind::dielectric, .ior = 1.5F, .absorption = {0.4F, 0.1F, 0.2F}});
  scene.instances.push_back({.name = "glass"});
  scene.instances[0].to_world =
      glm::scale(glm::rotate(glm::translate(glm::mat4(1.0F), {0.1F, -0.05F, 0.0F}), 0.5F, glm::vec3(0, 1, 0)), scale);
  scene.environment.zenith = {0.2F, 0.4F, 0.9F};
  scene.environment.horizon = {1.0F, 0.8F, 0.6F};
  scene.environment.ground = {0.1F, 0.15F, 0.05F};
  scene.views.push_back({.name = "front", .eye = {0.4F, 0.6F, 3.4F}, .target = glm::vec3(0.0F), .fov_y_deg = 40.0F});
  return scene;
}

Settings settings(const test::Values& values, const std::string& technique = "geocube") {
  Settings s;
  s.technique = technique;
  s.values = {{"frame.format", "single"}};
  if (technique == "geocube")
    s.values.insert(s.values.end(), {{"cubes", "1"}, {"placement", "middle"}, {"resolution", "32"}});
  s.values.insert(s.values.end(), values.begin(), values.end());
  return s;
}

Image truth(const Scene& scene, const Settings& s, SurfaceOptions options) {
  Camera camera;
  camera.view = scene.views.front();
  camera.width = s.width;
  camera.height = s.height;
  return trace_surfaces(scene, camera, options).radiance;
}

TEST(GeocubeRender, ABallAndAnUnevenlyScaledOneAreAsTraced) {
  for (const glm::vec3 scale : {glm::vec3(0.9F), glm::vec3(1.0F, 0.55F, 0.8F)}) {
    for (const int reflections : {0, 2}) {
      const Settings s = settings({{"reflections", std::to_string(reflections)}});
      SurfaceOptions options;
      options.reflections = reflections;
      const Image reference = truth(glass_scene(make_sphere(1, 80), scale), s, options);
      const Image image = frame(glass_scene(make_sphere(1, 80), scale), s);
      EXPECT_EQ(not_finite(image), 0);
      EXPECT_LT(difference(image, reference).mean, 0.006) << scale.y << ' ' << reflections;
    }
  }
}

TEST(GeocubeRender, MorePreciseCubesAreNearerToTheTruth) {
  const Settings coarse = settings({{"resolution", "8"}}), fine = settings({{"resolution", "64"}});
  const auto scene = [] { return glass_scene(make_star({}, 84)); };
  SurfaceOptions options;
  options.reflections = 1;
  const Image reference = truth(scene(), fine, options);
  const double at8 = difference(frame(scene(), coarse), reference).mean;
  const double at64 = difference(frame(scene(), fine), reference).mean;
  EXPECT_LT(at64, 0.6 * at8);
  EXPECT_LT(at64, 0.02);
}

TEST(GeocubeRender, StagesTablesAndLayersDrawTheSamePicture) {
  const auto scene = [] { return glass_scene(make_sphere(1, 64), {1.0F, 0.7F, 0.8F}); };
  const Image plain = frame(scene(), settings({}));
  EXPECT_LT(difference(frame(scene(), settings({{"functions", "table"}})), plain).mean, 0.003);
  EXPECT_LT(difference(frame(scene(), settings({{"stage", "split"}})), plain).mean, 0.01);
  EXPECT_LT(difference(frame(scene(), settings({{"layers", "2"}})), plain).mean, 0.004);
  EXPECT_GT(difference(frame(scene(), settings({{"reflections", "0"}})), plain).mean, 1e-4);
  EXPECT_GT(difference(frame(scene(), settings({{"show", "steps"}})), plain).mean, 0.01);
}

TEST(GeocubeRender, FrontRefractionAlone) {
  const auto scene = [] {
    Scene s = glass_scene(make_sphere(1, 80));
    s.materials[0].absorption = glm::vec3(0.0F);
    return s;
  };
  SurfaceOptions options;
  options.both_sides = false;
  const Settings s = settings({}, "front_refraction");
  const Image image = frame(scene(), s);
  EXPECT_LT(difference(image, truth(scene(), s, options)).mean, 0.004);
  EXPECT_GT(difference(image, frame(scene(), settings({}))).mean, 0.02);
}

TEST(GeocubeRender, TellsItsOwnErrors) {
  RenderSession session =
      test::start(glass_scene(make_torus(0.8F, 0.3F, 48)),
                  settings({{"placement", "automatic"}, {"cubes", "4"}, {"resolution", "32"}, {"iterations", "40"}}));
  gl::PassTimer timer;
  session.render(timer);
  nlohmann::json errors;
  session.technique().native_errors(errors);
  EXPECT_EQ(errors.at("cubes_placed"), 4);
  EXPECT_GT(errors.at("object_pixels"), 500);
  EXPECT_LT(errors.at("exit_error_mean"), 0.01);
  EXPECT_LT(errors.at("bounded_share"), 0.02);
  EXPECT_GT(errors.at("steps_mean"), 1);
  session.assign_text("iterations", "1");
  session.render(timer);
  nlohmann::json bounded;
  session.technique().native_errors(bounded);
  EXPECT_GT(bounded.at("bounded_share"), 0.1);
  EXPECT_GT(bounded.at("exit_error_mean"), errors.at("exit_error_mean"));
}

TEST(GeocubeRender, NewIndicesAndScalesTakeNewCubes) {
  RenderSession session = test::start(glass_scene(make_sphere(1, 64)), settings({}));
  gl::PassTimer timer;
  session.render(timer);
  session.scene().materials[0].ior = 1.2F;
  session.render(timer);
  const Image image = session.read_color();
  Scene scene = glass_scene(make_sphere(1, 64));
  scene.materials[0].ior = 1.2F;
  EXPECT_LT(difference(image, frame(std::move(scene), settings({}))).max, 1e-4);
}

TEST(GeocubeRender, RefusesWhatIsNoSolid) {
  Mesh open = make_sphere(1, 32);
  open.triangles.resize(open.triangles.size() / 2);
  test::Settings s = settings({});
  try {
    frame(glass_scene(open), s);
    ADD_FAILURE() << "an open mesh was drawn";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("it is open"), std::string::npos) << e.what();
  }
  EXPECT_NO_THROW(frame(glass_scene(open), settings({{"holes", "cap"}, {"placement", "automatic"}})));
  EXPECT_THROW(frame(glass_scene(make_torus(0.8F, 0.3F, 32)), settings({})), InputError) << "its middle is outside";
  EXPECT_THROW(frame(glass_scene(make_sphere(1, 32)), settings({{"layers", "2"}, {"stage", "split"}})), InputError);
  EXPECT_THROW(frame(glass_scene(make_sphere(1, 32)), settings({{"placement", "hand"}, {"cubes", "3"}})), InputError);
}

}  // namespace
}  // namespace pellucid
