// Scattering media in the geocube: Chan and Wang 2005, Sec. 3.
#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "algorithms/reference/reference.hpp"
#include "algorithms/scattering/transfer_table.hpp"
#include "gl/error.hpp"
#include "tests/algorithms/geocube/geocube_solids.hpp"
#include "tests/algorithms/rendered.hpp"

namespace pellucid {
namespace {

using test::difference;
using test::frame;
using test::Settings;

Scene ball(const glm::vec3& scattering, float anisotropy = 0.9F, const glm::vec3& absorption = glm::vec3(0.0F)) {
  ::setenv("PELLUCID_CACHE", "off", 1);
  Scene scene;
  scene.name = "ball";
  scene.meshes.push_back(make_sphere(1, 80));
  scene.meshes[0].name = "ball";
  scene.materials.push_back({.name = "medium",
                             .kind = SurfaceKind::dielectric,
                             .ior = 1.3F,
                             .absorption = absorption,
                             .scattering = scattering,
                             .anisotropy = anisotropy});
  scene.instances.push_back({.name = "ball"});
  scene.environment.zenith = scene.environment.horizon = scene.environment.ground = glm::vec3(1.0F);
  scene.views.push_back({.name = "front", .eye = {0.0F, 0.2F, 3.4F}, .target = glm::vec3(0.0F), .fov_y_deg = 40.0F});
  return scene;
}

// A dark place with a lamp behind the ball, as wide as a standard deviation of `width` [rad].
void light_from_behind(Scene& scene, double width) {
  Image image(256, 128, 3);
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 256; ++x) {
      const double azimuth = (x + 0.5 - 128) / 256 * 2 * M_PI, height = (64 - y - 0.5) / 128 * M_PI;
      const double off = std::acos(std::cos(height) * std::cos(azimuth));
      for (int c = 0; c < 3; ++c)
        image.at(x, y)[c] = 0.05F + 10.0F * static_cast<float>(std::exp(-0.5 * off * off / (width * width)));
    }
  }
  scene.environment.image = std::move(image);
}

Settings settings(const test::Values& values) {
  Settings s;
  s.technique = "geocube";
  s.width = s.height = 96;
  s.values = {{"frame.format", "single"}, {"cubes", "1"},      {"placement", "middle"},
              {"resolution", "32"},       {"face_size", "64"}, {"reflections", "4"}};
  s.values.insert(s.values.end(), values.begin(), values.end());
  return s;
}

TEST(GeocubeTranslucency, ABallThatAbsorbsNothingVanishesInAFurnace) {
  // Where the clear ball is darker, at its limb, the light is lost by `reflections`, and what scatters loses it there
  // too.
  const Image clear = frame(ball(glm::vec3(0)), settings({{"reflections", "16"}}));
  int left_out = 0;
  for (int y = 0; y < clear.height; ++y) {
    for (int x = 0; x < clear.width; ++x)
      left_out += clear.at(x, y)[1] < 0.998F ? 1 : 0;
  }
  EXPECT_LT(left_out, clear.width * clear.height / 20);
  for (const char* transfer : {"gaussian", "unscattered", "two_gaussians"}) {
    for (const glm::vec3 scattering : {glm::vec3(0.05F), glm::vec3(1.0F, 3.0F, 0.2F), glm::vec3(60.0F)}) {
      const Image image = frame(ball(scattering), settings({{"transfer", transfer}, {"reflections", "16"}}));
      for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
          if (clear.at(x, y)[1] < 0.998F) continue;
          for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(image.at(x, y)[c], 1.0F, 0.01F) << transfer << ' ' << scattering.y << ' ' << x << ' ' << y;
        }
      }
    }
  }
}

TEST(GeocubeTranslucency, BeginsWhereTheTransparentPictureIs) {
  const auto scene = [](float scattering) {
    Scene s = ball(glm::vec3(scattering), 0.9F, {0.3F, 0.1F, 0.6F});
    light_from_behind(s, 0.2);
    return s;
  };
  const Image clear = frame(scene(0), settings({}));
  for (const char* transfer : {"gaussian", "unscattered", "two_gaussians"}) {
    // A thousandth of a metre⁻¹ scatters 0.2 % of the light over the longest way.
    EXPECT_LT(difference(frame(scene(0.001F), settings({{"transfer", transfer}})), clear).mean, 0.004) << transfer;
  }
}

TEST(GeocubeTranslucency, HasNoJumpOnItsWayToOpaque) {
  const auto at = [](float scattering) {
    Scene s = ball(glm::vec3(scattering), 0.9F, glm::vec3(0.1F));
    light_from_behind(s, 0.2);
    return frame(std::move(s), settings({}));
  };
  Image before = at(0);
  for (float scattering = 0.1F; scattering < 40; scattering *= 1.25F) {
    const Image now = at(scattering);
    // A quarter more of the medium changes a lamp of 10 by a part of it, never all.
    EXPECT_LT(difference(now, before).mean, 0.2) << scattering;
    before = now;
  }
}

TEST(GeocubeTranslucency, AColouredMediumIsItsChannels) {
  const auto picture = [](const glm::vec3& scattering) {
    Scene s = ball(scattering, 0.85F, glm::vec3(0.2F));
    light_from_behind(s, 0.3);
    return frame(std::move(s), settings({{"transfer", "unscattered"}}));
  };
  const Image coloured = picture({0.5F, 2.0F, 6.0F});
  const Image grey[] = {picture(glm::vec3(0.5F)), picture(glm::vec3(2.0F)), picture(glm::vec3(6.0F))};
  for (int y = 0; y < coloured.height; ++y) {
    for (int x = 0; x < coloured.width; ++x) {
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(coloured.at(x, y)[c], grey[c].at(x, y)[c], 2e-3F) << x << ' ' << y << ' ' << c;
    }
  }
}

TEST(GeocubeTranslucency, IsNearerToThePathTracedTruthThanTheClearFrame) {
  Scene scene = ball(glm::vec3(1.0F), 0.9F);
  light_from_behind(scene, 0.25);
  const Settings s = settings({{"transfer", "unscattered"}});
  Camera camera;
  camera.view = scene.views.front();
  camera.width = s.width;
  camera.height = s.height;
  SurfaceOptions options;
  options.samples = 64;
  const Image truth = trace_surfaces(scene, camera, options).radiance;
  Scene clear = ball(glm::vec3(0.0F));
  light_from_behind(clear, 0.25);
  const double apart = difference(frame(std::move(scene), s), truth).mean;
  const double clear_apart = difference(frame(std::move(clear), s), truth).mean;
  EXPECT_LT(apart, 0.5 * clear_apart);
}

TEST(GeocubeTranslucency, TellsWhatItsMapsTake) {
  Scene scene = ball(glm::vec3(1.0F));
  light_from_behind(scene, 0.25);
  RenderSession session = test::start(std::move(scene), settings({}));
  gl::PassTimer timer;
  session.render(timer);
  nlohmann::json out;
  session.technique().native_errors(out);
  EXPECT_GT(out.at("key_map_bytes").get<double>(), 0);
  EXPECT_GT(out.at("key_map_full_bytes").get<double>(), 4 * out.at("key_map_bytes").get<double>());
}

TEST(GeocubeTranslucency, RefusesFaceSizesThatAreNoPowerOfTwo) {
  Scene scene = ball(glm::vec3(1.0F));
  light_from_behind(scene, 0.25);
  EXPECT_THROW(frame(std::move(scene), settings({{"face_size", "100"}})), InputError);
}

}  // namespace
}  // namespace pellucid
