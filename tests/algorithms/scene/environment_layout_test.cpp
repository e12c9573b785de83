#include "algorithms/scene/images/environment_layout.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <ImfEnvmap.h>
#include <glm/glm.hpp>
#include <gtest/gtest.h>

#include "algorithms/scene/scene.hpp"
#include "tests/algorithms/scene/folder_test.hpp"

namespace pellucid {
namespace {

constexpr double kMost = 1e9;

/// A radiance that is linear in the direction, so that bilinear resampling keeps it but for the curvature of a pixel.
glm::vec3 sky(const glm::dvec3& d) {
  return glm::vec3(d * 0.5 + 0.5);
}

PictureFile picture(int width, int height, const std::function<glm::dvec3(double x, double y)>& direction) {
  PictureFile file;
  file.image = Image(width, height, 3);
  file.data_window = file.display_window = {0, 0, width - 1, height - 1};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const glm::vec3 value = sky(glm::normalize(direction(x, y)));
      std::copy_n(&value.x, 3, file.image.at(x, y));
    }
  }
  return file;
}

/// Every direction shows what the sky has there.
void expect_sky(PictureFile file, std::optional<EnvironmentLayout> layout, double tolerance) {
  std::vector<std::string> warnings;
  Environment environment;
  environment.image = to_lat_long(std::move(file), layout, kMost, warnings);
  EXPECT_TRUE(warnings.empty()) << warnings.front();
  for (int i = 0; i < 500; ++i) {
    const double z = 2 * (i + 0.5) / 500 - 1, a = 2.399963 * i, r = std::sqrt(1 - z * z);
    const glm::dvec3 d(r * std::cos(a), z, r * std::sin(a));
    const glm::vec3 found = environment.radiance(glm::vec3(d)), right = sky(d);
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(found[c], right[c], tolerance) << d.x << " " << d.y << " " << d.z;
  }
}

/// OpenEXR's own functions say where a direction lies.
PictureFile openexr_cube(int side) {
  PictureFile file;
  file.image = Image(side, 6 * side, 3);
  file.envmap = PictureFile::Envmap::cube;
  file.data_window = file.display_window = {0, 0, side - 1, 6 * side - 1};
  const Imath::Box2i window({0, 0}, {side - 1, 6 * side - 1});
  for (int face = 0; face < 6; ++face) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const Imath::V2f at(static_cast<float>(x), static_cast<float>(y));
        const auto number = static_cast<Imf::CubeMapFace>(face);
        const Imath::V3f d = Imf::CubeMap::direction(number, window, at).normalized();
        const Imath::V2f pixel = Imf::CubeMap::pixelPosition(number, window, at);
        const glm::vec3 value = sky({d.x, d.y, d.z});
        std::copy_n(&value.x, 3,
                    file.image.at(static_cast<int>(std::lround(pixel.x)), static_cast<int>(std::lround(pixel.y))));
      }
    }
  }
  return file;
}

TEST(EnvironmentLayout, ACubeFaceMapOfOpenExrIsResampledByItsAttribute) {
  expect_sky(openexr_cube(64), std::nullopt, 0.01);
}

/// The direction through a face's pixel: column and row in [0, side).
glm::dvec3 through(const glm::dvec3& forward, const glm::dvec3& right, const glm::dvec3& up, int side, double x,
                   double y) {
  return forward + right * (2 * (x + 0.5) / side - 1) + up * (1 - 2 * (y + 0.5) / side);
}

TEST(EnvironmentLayout, StripsAndCrossesAreReadWhenSaidSo) {
  constexpr int n = 64;
  using V = glm::dvec3;
  const V right[6] = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {1, 0, 0}, {-1, 0, 0}, {1, 0, 0}};
  const V up[6] = {{0, 1, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}, {0, 1, 0}, {0, 1, 0}};
  const V forward[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  const auto face = [&](int f, double x, double y) { return through(forward[f], right[f], up[f], n, x, y); };
  expect_sky(picture(6 * n, n, [&](double x, double y) { return face(static_cast<int>(x) / n, std::fmod(x, n), y); }),
             EnvironmentLayout::cube_strip, 0.01);
  expect_sky(picture(n, 6 * n, [&](double x, double y) { return face(static_cast<int>(y) / n, x, std::fmod(y, n)); }),
             EnvironmentLayout::cube_strip, 0.01);
  // Unfolded around −z: what is left of it is −x, above it +y.
  const int lying[3][4] = {{0, 2, 0, 0}, {1, 5, 0, 4}, {0, 3, 0, 0}};
  expect_sky(picture(4 * n, 3 * n,
                     [&](double x, double y) {
                       return face(lying[static_cast<int>(y) / n][static_cast<int>(x) / n], std::fmod(x, n),
                                   std::fmod(y, n));
                     }),
             EnvironmentLayout::cube_cross, 0.01);
  const int standing[4][3] = {{0, 2, 0}, {1, 5, 0}, {0, 3, 0}, {0, 4, 0}};
  expect_sky(picture(3 * n, 4 * n,
                     [&](double x, double y) {
                       const int row = static_cast<int>(y) / n, f = standing[row][static_cast<int>(x) / n];
                       const double u = std::fmod(x, n), v = std::fmod(y, n);
                       return row == 3 ? face(f, n - 1 - u, n - 1 - v) : face(f, u, v);
                     }),
             EnvironmentLayout::cube_cross, 0.01);
}

TEST(EnvironmentLayout, BallsAndProbesAreReadWhenSaidSo) {
  constexpr int n = 512;
  const auto disc = [](double x, double y) { return glm::dvec2(2 * (x + 0.5) / n - 1, 1 - 2 * (y + 0.5) / n); };
  // A view along −z reflected at the normal (px, py, √(1 − r²)); towards the rim a pixel is many degrees.
  expect_sky(picture(n, n,
                     [&](double x, double y) {
                       const glm::dvec2 p = disc(x, y);
                       const double r2 = std::min(glm::dot(p, p), 1.0);
                       const glm::dvec3 normal(glm::dvec2(p) * std::min(1.0, 1 / std::max(glm::length(p), 1e-9)),
                                               std::sqrt(1 - r2)),
                           view(0, 0, -1);
                       const glm::dvec3 m = r2 < 1 ? glm::dvec3(p, std::sqrt(1 - r2)) : normal;
                       return view - 2.0 * glm::dot(view, m) * m;
                     }),
             EnvironmentLayout::mirror_ball, 0.09);
  expect_sky(
      picture(n, n,
              [&](double x, double y) {
                const glm::dvec2 p = disc(x, y);
                const double angle = std::min(glm::length(p), 1.0) * std::numbers::pi, turn = std::atan2(p.y, p.x);
                return glm::dvec3(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), -std::cos(angle));
              }),
      EnvironmentLayout::angular, 0.02);
}

std::string message_for(int width, int height, std::optional<EnvironmentLayout> layout = std::nullopt) {
  std::vector<std::string> warnings;
  PictureFile file = picture(width, height, [](double, double) { return glm::dvec3(0, 1, 0); });
  try {
    to_lat_long(std::move(file), layout, kMost, warnings);
  } catch (const InputError& error) {
    return error.what();
  }
  return warnings.empty() ? "" : warnings.front();
}

TEST(EnvironmentLayout, OtherShapesAreRefusedOrTold) {
  EXPECT_EQ(message_for(64, 32), "");
  EXPECT_EQ(message_for(100, 40),
            "100x40 pixels are not 2:1, the shape of a lat-long environment; it is stretched over the sphere");
  EXPECT_NE(message_for(40, 40).find("say layout = \"mirror_ball\""), std::string::npos);
  EXPECT_NE(message_for(16, 96).find("say layout = \"cube_strip\""), std::string::npos);
  EXPECT_NE(message_for(64, 48).find("\"cube_cross\""), std::string::npos);
  EXPECT_EQ(message_for(40, 40, EnvironmentLayout::lat_long).substr(0, 24), "40x40 pixels are not 2:1");
  EXPECT_EQ(message_for(64, 32, EnvironmentLayout::cube_strip),
            "64x32 pixels are no strip of cube faces, which is 6:1");
  EXPECT_EQ(message_for(64, 32, EnvironmentLayout::mirror_ball), "64x32 pixels are not 1:1, the shape of a ball");
}

TEST(EnvironmentLayout, PixelsThatAreNoRadiance) {
  std::vector<std::string> warnings;
  const auto with = [](float value) {
    PictureFile file = picture(8, 4, [](double, double) { return glm::dvec3(0, 1, 0); });
    file.image.pixels[5] = value;
    return file;
  };
  EXPECT_EQ(test::message_of([&] { to_lat_long(with(std::numeric_limits<float>::quiet_NaN()), {}, kMost, warnings); }),
            "it has a pixel that is not finite");
  EXPECT_EQ(test::message_of([&] { to_lat_long(with(3e38F), {}, kMost, warnings); }),
            "it has a pixel of radiance 3e+38; at most 1e+09 is read");
  const Image image = to_lat_long(with(-0.25F), {}, kMost, warnings);
  EXPECT_EQ(image.pixels[5], 0.0F);
  EXPECT_EQ(warnings, std::vector<std::string>{"1 of its values are below 0, down to -0.25; they are taken for 0"});
}

}  // namespace
}  // namespace pellucid
