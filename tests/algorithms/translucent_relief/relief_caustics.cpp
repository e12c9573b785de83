// Light that a medium's surface gathers on the solid, against closed forms.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "algorithms/shaders/optics.hpp"
#include "algorithms/translucent_relief/caustic_charts.hpp"
#include "gl/error.hpp"
#include "tests/algorithms/relief_scenes.hpp"
#include "tests/algorithms/rendered.hpp"

namespace pellucid {
namespace {

using namespace test;

constexpr double kIndex = 1.33, kGroundAlbedo = 0.8, kAmbient = 0.2;
constexpr int kWidth = 96, kHeight = 72;

Settings gathering(const char* caustics = "true", const char* resolution = "128") {
  return {.technique = "translucent_relief",
          .values = {{"caustics", caustics}, {"caustic_resolution", resolution}, {"frame.format", "single"}},
          .view = "front",
          .width = kWidth,
          .height = kHeight};
}

// Level: the solid at −0.25 m, the medium's surface at −0.05 m.
Relief level_layers() {
  Relief relief;
  relief.cut = false;
  relief.solid = flat_layer(-0.25F, -0.5F);
  relief.solid.albedo = glm::vec3(static_cast<float>(kGroundAlbedo));
  relief.translucent = flat_layer(-0.05F, -0.5F);
  relief.absorption = {1.0F, 2.0F, 5.0F};
  return relief;
}

// The largest difference from what a medium without highlights shows of a level solid at `solid_m`. `surface(p)`: moves
// a point of a view ray, with the unit direction given, to the medium's surface and returns the normal there;
// `irradiance(q, c)`: on the solid.
double worst_over(const Scene& scene, const Image& image, double solid_m,
                  const std::function<glm::dvec3(glm::dvec3& p, const glm::dvec3& v)>& surface,
                  const std::function<double(const glm::dvec3& q, int c)>& irradiance) {
  const Camera camera{scene.views[0], kWidth, kHeight};
  double worst = 0;
  for (int y = kHeight / 3; y < 2 * kHeight / 3; ++y) {
    for (int x = kWidth / 3; x < 2 * kWidth / 3; ++x) {
      const glm::dvec3 v = camera.ray_direction(x + 0.5, y + 0.5);
      glm::dvec3 p(camera.view.eye);
      const glm::dvec3 n = surface(p, v);
      const double reflected_share = fresnel_dielectric(-glm::dot(v, n), 1 / kIndex);
      const glm::dvec3 inside = *refracted(v, n, 1 / kIndex);
      const double way = (p.y - solid_m) / -inside.y;
      for (int c = 0; c < 3; ++c) {
        const double seen = std::exp(-static_cast<double>(scene.reliefs[0].absorption[c]) * way) * kGroundAlbedo *
                            (kAmbient + irradiance(p + way * inside, c) / std::numbers::pi);
        const double expected =
            (1 - reflected_share) * seen + reflected_share * static_cast<double>(scene.environment.zenith[c]);
        worst = std::max(worst, std::abs(static_cast<double>(image.at(x, y)[c]) - expected));
      }
    }
  }
  return worst;
}

glm::dvec3 level_surface(glm::dvec3& p, const glm::dvec3& v) {
  p += (p.y + 0.05) / -v.y * v;
  return {0, 1, 0};
}

// Nothing is gathered: the light is what Snell, Fresnel and absorption leave of it, bent.
TEST(ReliefCaustics, ALevelSurfaceInTheSun) {
  const Scene scene = relief_scene(level_layers());
  const double inner = std::sqrt(1 - 0.36 / (kIndex * kIndex));
  const auto irradiance = [&](const glm::dvec3&, int c) {
    return (1 - fresnel_dielectric(0.8, 1 / kIndex)) *
           std::exp(-static_cast<double>(scene.reliefs[0].absorption[c]) * 0.2 / inner) *
           static_cast<double>(scene.lights[0].intensity[c]) * 0.8;
  };
  EXPECT_LT(worst_over(scene, frame(relief_scene(level_layers()), gathering()), -0.25, level_surface, irradiance),
            1e-4);
}

// The power that a lamp sends into a ring of directions falls on a ring of the solid: r = a tan θ₁ + d tan θ₂.
TEST(ReliefCaustics, ALampOverALevelSurface) {
  const glm::dvec3 lamp(0.5, 0.7, 0.2);
  const double over = lamp.y + 0.05, depth = 0.2;
  for (const LightKind kind : {LightKind::point, LightKind::spot}) {
    const auto make = [&] {
      Scene scene = relief_scene(level_layers());
      Light& light = scene.lights[0];
      light.kind = kind;
      light.position = glm::vec3(lamp);
      light.direction = {0.0F, -1.0F, 0.0F};
      light.inner_angle_deg = 60.0F;  // all that is looked at lies in the full cone
      light.outer_angle_deg = 70.0F;
      return scene;
    };
    const Scene scene = make();
    const auto irradiance = [&](const glm::dvec3& q, int c) {
      const double r = std::hypot(q.x - lamp.x, q.z - lamp.z);
      const auto inner_sine = [](double sine) { return sine / kIndex; };
      const auto reach = [&](double angle) {
        const double sine = inner_sine(std::sin(angle));
        return over * std::tan(angle) + depth * sine / std::sqrt(1 - sine * sine);
      };
      double low = 0, high = 1.5;
      for (int i = 0; i < 60; ++i)
        (reach(0.5 * (low + high)) < r ? low : high) = 0.5 * (low + high);
      const double slope = (reach(low + 1e-5) - reach(low - 1e-5)) / 2e-5;
      const double inner = std::sqrt(1 - std::pow(inner_sine(std::sin(low)), 2));
      return static_cast<double>(scene.lights[0].intensity[c]) * (1 - fresnel_dielectric(std::cos(low), 1 / kIndex)) *
             std::exp(-static_cast<double>(scene.reliefs[0].absorption[c]) * depth / inner) * std::sin(low) /
             (r * slope);
    };
    // Triangles of the grid are as bright as their corners: 64 over 2 m.
    EXPECT_LT(worst_over(scene, frame(make(), gathering()), -0.25, level_surface, irradiance), 2e-3);
  }
}

// Waves gather light from above before its rays cross: where x goes to x'(x), by 1 / |dx'/dx|.
TEST(ReliefCaustics, CosineWavesBeforeTheirFocus) {
  constexpr double kMean = -0.1, kAmplitude = 0.05, kPeriod = 0.5, kSolid = -0.3;
  const double wave_number = 2 * std::numbers::pi / kPeriod;
  const auto make = [&] {
    Relief relief = level_layers();
    relief.absorption = glm::vec3(0.0F);
    relief.solid = flat_layer(static_cast<float>(kSolid), -0.5F);
    relief.solid.albedo = glm::vec3(static_cast<float>(kGroundAlbedo));
    Image heights(1024, 1, 1);  // slopes are linear between texels: gains are as far off as those
    for (int i = 0; i < 1024; ++i)
      heights.pixels[static_cast<std::size_t>(i)] =
          static_cast<float>(0.5 + 0.5 * std::cos(wave_number * ((i + 0.5) / 512 - 1)));
    relief.translucent =
        layer_of(std::move(heights), static_cast<float>(kMean - kAmplitude), static_cast<float>(kMean + kAmplitude));
    Scene scene = relief_scene(relief);
    scene.lights[0].direction = {0.0F, -1.0F, 0.0F};
    scene.views[0] = {.name = "front", .eye = {0.1F, 3.0F, 0.0F}, .target = {0.1F, 0.0F, -0.01F}, .fov_y_deg = 25.0F};
    return scene;
  };
  const Scene scene = make();
  const auto height = [&](double x) { return kMean + kAmplitude * std::cos(wave_number * x); };
  const auto normal = [&](double x) {
    return glm::normalize(glm::dvec3(kAmplitude * wave_number * std::sin(wave_number * x), 1, 0));
  };
  const auto lands = [&](double x) {
    const glm::dvec3 inside = *refracted(glm::dvec3(0, -1, 0), normal(x), 1 / kIndex);
    return x + (height(x) - kSolid) * inside.x / -inside.y;
  };
  const auto surface = [&](glm::dvec3& p, const glm::dvec3& v) {
    p += (p.y - kMean - kAmplitude) / -v.y * v;
    for (double step = 2.1 * kAmplitude / -v.y; step > 1e-9; step *= 0.5) {
      const glm::dvec3 next = p + step * v;
      if (next.y > height(next.x)) p = next;
    }
    return normal(p.x);
  };
  double brightest = 0;
  const auto irradiance = [&](const glm::dvec3& q, int c) {
    double low = q.x - 0.25, high = q.x + 0.25;
    for (int i = 0; i < 60; ++i)
      (lands(0.5 * (low + high)) < q.x ? low : high) = 0.5 * (low + high);
    const double gain = 2e-5 / (lands(low + 1e-5) - lands(low - 1e-5));
    brightest = std::max(brightest, gain);
    return static_cast<double>(scene.lights[0].intensity[c]) * (1 - fresnel_dielectric(normal(low).y, 1 / kIndex)) *
           gain;
  };
  const double worst = worst_over(scene, frame(make(), gathering("true", "512")), kSolid, surface, irradiance);
  EXPECT_GT(brightest, 1.5) << "crests gather light";
  // The radiance is up to 1.6; each triangle of the grid, 64 over a period, is spread evenly.
  EXPECT_LT(worst, 0.03);
}

// Thin level layers around a capped cylinder, whose pieces have the same texture coordinates: clear, they leave each
// place the light that straight rays do.
TEST(ReliefCaustics, AroundACylinder) {
  const auto make = [] {
    Relief relief = level_layers();
    relief.absorption = glm::vec3(0.0F);
    relief.solid = flat_layer(-0.006F, -0.02F);
    relief.solid.albedo = glm::vec3(static_cast<float>(kGroundAlbedo));
    relief.translucent = flat_layer(-0.001F, -0.02F);
    Scene scene = relief_scene(relief);
    scene.meshes[0] = make_cylinder(0.4F, 0.6F, 96);
    return scene;
  };
  const Image gathered = frame(make(), gathering()), straight = frame(make(), gathering("false"));
  // The tangent planes' light turns by some of the depth over the radius.
  EXPECT_LT(difference(gathered, straight).mean, 2e-3);
  EXPECT_GT(std::max(gathered.at(kWidth / 2, kHeight / 2)[0], gathered.at(kWidth / 2, kHeight / 4)[0]), 0.3F);
}

// The same on a third of a cylinder, open on all sides, with the sun over its left edge: light that reaches the solid
// there comes in over the edge, and the far edge, whose maps repeat here, has none to give.
TEST(ReliefCaustics, OverAnOpenEdge) {
  const auto make = [] {
    Relief relief = level_layers();
    relief.absorption = glm::vec3(0.0F);
    relief.solid = flat_layer(-0.06F, -0.1F);
    relief.solid.albedo = glm::vec3(static_cast<float>(kGroundAlbedo));
    relief.translucent = flat_layer(-0.001F, -0.1F);
    Scene scene = relief_scene(relief);
    constexpr int kSteps = 24;
    Mesh& mesh = scene.meshes[0] = {};
    mesh.name = "third of a cylinder";
    for (unsigned i = 0; i <= kSteps; ++i) {
      const float share = static_cast<float>(i) / kSteps, angle = 2.1F * (share - 0.5F);
      const glm::vec3 normal(std::sin(angle), 0.0F, std::cos(angle));
      for (const float v : {0.0F, 1.0F}) {
        mesh.positions.push_back(0.4F * normal + glm::vec3(0.0F, 0.6F * (v - 0.5F), 0.0F));
        mesh.normals.push_back(normal);
        mesh.uvs.emplace_back(share, v);
      }
      if (i == kSteps) break;
      mesh.triangles.insert(mesh.triangles.end(), {{2 * i, 2 * i + 2, 2 * i + 3}, {2 * i, 2 * i + 3, 2 * i + 1}});
    }
    scene.lights[0].direction = glm::normalize(glm::vec3(1.0F, 0.0F, 0.12F));
    scene.views[0] = {.name = "front", .eye = {-1.2F, 0.0F, 0.7F}, .target = {-0.3F, 0.0F, 0.2F}, .fov_y_deg = 25.0F};
    return scene;
  };
  const Image gathered = frame(make(), gathering()), straight = frame(make(), gathering("false"));
  // As above, by more of the depth over the radius. Light from the far edge would leave 0.58 of 0.74 away.
  EXPECT_LT(difference(gathered, straight).mean, 8e-3);
  EXPECT_LT(difference(gathered, straight).max, 0.05);
  EXPECT_GT(gathered.at(kWidth / 2 - 4, kHeight / 2)[0], 0.5F);
}

TEST(ReliefCaustics, ChartsOfAMesh) {
  const auto charts = translucent_relief::caustic_charts(make_cylinder(0.4F, 0.6F, 24), 33, "it");
  ASSERT_EQ(charts.layers.size(), 3U) << "the side, and two discs over each other and over it";
  EXPECT_FALSE(charts.affine);
  EXPECT_EQ(charts.closes[0], glm::bvec2(true, false)) << "around it";
  const auto plane = translucent_relief::caustic_charts(make_plane({2.0F, 1.0F}, 4), 17, "it");
  EXPECT_TRUE(plane.affine);
  EXPECT_EQ(plane.closes[0], glm::bvec2(false, false));
  for (const auto& node : plane.layers[0])
    EXPECT_EQ(node.position.w, 1.0F);
  const auto words = [](const Mesh& mesh) -> std::string {
    try {
      translucent_relief::caustic_charts(mesh, 17, "'it'");
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  Mesh wide = make_plane({2.0F, 2.0F}, 1);
  for (glm::vec2& uv : wide.uvs)
    uv *= 2.0F;
  EXPECT_EQ(words(wide),
            "translucent_relief: caustics = true cannot lie on 'it': its texture coordinates go beyond [0, 1]");
  Mesh folded = make_plane({2.0F, 2.0F}, 2);
  for (glm::vec2& uv : folded.uvs)
    uv.x = uv.x < 0.4F ? 0.9F : uv.x > 0.6F ? 0.8F : 0.1F;
  EXPECT_EQ(words(folded),
            "translucent_relief: caustics = true cannot lie on 'it': parts of it that hang together have the same "
            "texture coordinates");
}

}  // namespace
}  // namespace pellucid
