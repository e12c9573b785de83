// Scattering media in the geocube: Chan and Wang 2005, Sec. 3.
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "algorithms/reference/reference.hpp"
#include "algorithms/scattering/slab.hpp"
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

Settings scattering_settings(const test::Values& values) {
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
  const Image clear = frame(ball(glm::vec3(0)), scattering_settings({{"reflections", "16"}}));
  int left_out = 0;
  for (int y = 0; y < clear.height; ++y) {
    for (int x = 0; x < clear.width; ++x)
      left_out += clear.at(x, y)[1] < 0.998F ? 1 : 0;
  }
  EXPECT_LT(left_out, clear.width * clear.height / 20);
  for (const char* transfer : {"gaussian", "unscattered", "two_gaussians"}) {
    for (const glm::vec3 scattering : {glm::vec3(0.05F), glm::vec3(1.0F, 3.0F, 0.2F), glm::vec3(60.0F)}) {
      const Image image = frame(ball(scattering), scattering_settings({{"transfer", transfer}, {"reflections", "16"}}));
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
  const Image clear = frame(scene(0), scattering_settings({}));
  for (const char* transfer : {"gaussian", "unscattered", "two_gaussians"}) {
    // A thousandth of a metre⁻¹ scatters 0.2 % of the light over the longest way.
    EXPECT_LT(difference(frame(scene(0.001F), scattering_settings({{"transfer", transfer}})), clear).mean, 0.004)
        << transfer;
  }
}

TEST(GeocubeTranslucency, HasNoJumpOnItsWayToOpaque) {
  // One session, and an albedo that stays, so that cubes and transfer functions are made once.
  Scene scene = ball(glm::vec3(0));
  light_from_behind(scene, 0.2);
  RenderSession session = test::start(std::move(scene), scattering_settings({}));
  const auto at = [&](float scattering) {
    Material& medium = session.scene().materials[0];
    medium.scattering = glm::vec3(scattering);
    medium.absorption = glm::vec3(0.02F * scattering);
    gl::PassTimer timer;
    session.render(timer);
    return session.read_color();
  };
  Image before = at(0);
  for (float scattering = 0.1F; scattering < 40; scattering *= 1.2F) {
    const Image now = at(scattering);
    // A fifth more of the medium changes a lamp of 10 by a part of it, never all.
    EXPECT_LT(difference(now, before).mean, 0.2) << scattering;
    before = now;
  }
}

// The lamp's centre, seen through a ball that does not bend light and is so long there.
TEST(GeocubeTranslucency, ALampBlursWithTheThicknessAsTheSlabPredictsAndStaysSharpAtTheLimb) {
  constexpr double kLampWidth = 0.1, kScattering = 1.5, kAnisotropy = 0.9;
  const auto lamp = [](double angle) { return 0.05 + 10 * std::exp(-0.5 * angle * angle / (kLampWidth * kLampWidth)); };
  const scattering::Slab slab({kAnisotropy, 1});
  for (const double length : {2.0, 1.2, 0.3}) {
    Scene scene = ball(glm::vec3(static_cast<float>(kScattering)), static_cast<float>(kAnisotropy));
    light_from_behind(scene, kLampWidth);
    scene.materials[0].ior = 1.001F;
    const auto aside = static_cast<float>(std::sqrt(1 - 0.25 * length * length));
    scene.views[0] = {.name = "front", .eye = {aside, 0, 4}, .target = {aside, 0, 0}, .fov_y_deg = 0.5F};
    Settings s = scattering_settings({{"transfer", "two_gaussians"}, {"resolution", "64"}, {"face_size", "256"}});
    s.width = s.height = 5;

    const scattering::SlabLight light = slab.light(kScattering * length);
    double predicted = (light.unscattered + light.near_forward) * lamp(0);
    for (std::size_t i = 0; i < light.cosine.size(); ++i) {
      const double flux = 2 * M_PI * light.weight[i] * light.cosine[i], angle = std::acos(light.cosine[i]);
      predicted += flux * (light.transmission[i] * lamp(angle) + light.reflection[i] * lamp(M_PI - angle));
    }
    Camera camera;
    camera.view = scene.views.front();
    camera.width = camera.height = 5;
    SurfaceOptions options;
    options.samples = 200;
    const Image truth = trace_surfaces(scene, camera, options).radiance;
    const Image drawn = frame(std::move(scene), s);
    const auto seen = [](const Image& image) { return static_cast<double>(image.at(2, 2)[1]); };
    double traced = 0;  // over all pixels, which see nearly the same
    for (int i = 0; i < 25; ++i)
      traced += static_cast<double>(truth.at(i % 5, i / 5)[1]) / 25;
    // The slab is endless and the ball is not: 2 % apart, and as much noise. The frame's two Gaussians and the maps
    // filtered by them miss the lamp's centre by 12 % where the blur is widest.
    EXPECT_NEAR(traced, predicted, 0.05 * predicted) << length;
    EXPECT_NEAR(seen(drawn), predicted, 0.16 * predicted) << length;
    EXPECT_NEAR(seen(drawn), traced, 0.16 * traced) << length;
    if (length < 0.5) {
      EXPECT_GT(seen(drawn), 0.7 * lamp(0));
    }
    if (length > 1.5) {
      EXPECT_LT(seen(drawn), 0.2 * lamp(0));
    }
  }
}

TEST(GeocubeTranslucency, AColouredMediumIsItsChannels) {
  const auto picture = [](const glm::vec3& scattering) {
    Scene s = ball(scattering, 0.85F, glm::vec3(0.2F));
    light_from_behind(s, 0.3);
    return frame(std::move(s), scattering_settings({{"transfer", "unscattered"}}));
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
  const Settings s = scattering_settings({{"transfer", "unscattered"}});
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
  RenderSession session = test::start(std::move(scene), scattering_settings({}));
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
  EXPECT_THROW(frame(std::move(scene), scattering_settings({{"face_size", "100"}})), InputError);
}

}  // namespace
}  // namespace pellucid
