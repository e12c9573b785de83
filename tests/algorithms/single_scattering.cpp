// One light through constant fog against the analytic single-scattering integral, which neither the shaders nor the
// reference know: no voxels, no steps, no code of theirs.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/algorithms/rendered.hpp"
#include "tests/algorithms/scenes.hpp"

namespace pellucid {
namespace {

using namespace test;

using std::numbers::pi;
constexpr double kExtinction = 0.4;
constexpr glm::dvec3 kAlbedo{0.75, 0.5, 0.25};
constexpr glm::dvec3 kHalf{2.0, 1.0, 1.5};  // of the fog's box, about the origin

Scene foggy(const Light& light, const View& view) {
  Scene scene;
  scene.name = "foggy";
  Volume fog;
  fog.name = "fog";
  fog.size = {3, 2, 4};
  fog.density = make_constant_density(fog.size, 0.5F);
  fog.extinction = static_cast<float>(2 * kExtinction);
  fog.albedo = glm::vec3(kAlbedo);
  fog.to_world =
      glm::translate(glm::mat4(1.0F), -glm::vec3(kHalf)) * glm::scale(glm::mat4(1.0F), 2.0F * glm::vec3(kHalf));
  scene.volume = fog;
  scene.lights.push_back(light);
  scene.views.push_back(view);
  return scene;
}

// Simpson's rule, halved until it no longer changes.
double adaptive(const std::function<double(double)>& f, double a, double b, double fa, double fm, double fb,
                double whole, double tolerance, int depth) {
  const double m = 0.5 * (a + b), f1 = f(0.5 * (a + m)), f2 = f(0.5 * (m + b));
  const double left = (m - a) / 6 * (fa + 4 * f1 + fm), right = (b - m) / 6 * (fm + 4 * f2 + fb);
  const double change = left + right - whole;
  if (depth <= 0 || std::abs(change) < 15 * tolerance) return left + right + change / 15;
  return adaptive(f, a, m, fa, f1, fm, left, tolerance / 2, depth - 1) +
         adaptive(f, m, b, fm, f2, fb, right, tolerance / 2, depth - 1);
}

double integral(const std::function<double(double)>& f, double a, double b) {
  const int parts = 16;  // so that no peak hides between the first five points
  double sum = 0;
  for (int i = 0; i < parts; ++i) {
    const double from = a + (b - a) * i / parts, to = a + (b - a) * (i + 1) / parts;
    const double fa = f(from), fm = f(0.5 * (from + to)), fb = f(to);
    sum += adaptive(f, from, to, fa, fm, fb, (to - from) / 6 * (fa + 4 * fm + fb), 1e-11, 40);
  }
  return sum;
}

// ∫ σ exp(−σ t) E(t) / 4π dt over the ray's way through the box from the near plane on; E: irradiance at distance t
// behind the beginning. The fog does not weaken the light on its way to the point (Imagire et al. 2007, Sec. 5).
glm::dvec3 scattered(const Light& light, const Camera& camera, int x, int y) {
  const glm::dvec3 eye(camera.view.eye), ray = camera.ray_direction(x + 0.5, y + 0.5);
  const glm::dvec3 axis = glm::normalize(glm::dvec3(camera.view.target) - eye);
  double begin = static_cast<double>(camera.view.near_m) / glm::dot(ray, axis), end = 1e9;
  for (int k = 0; k < 3; ++k) {
    const double a = (-kHalf[k] - eye[k]) / ray[k], b = (kHalf[k] - eye[k]) / ray[k];
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  if (end <= begin) return glm::dvec3(0.0);
  const glm::dvec3 colour(light.intensity);
  const double clear = std::exp(-kExtinction * (end - begin));
  if (light.kind == LightKind::directional) return kAlbedo * colour * ((1 - clear) / (4 * pi));

  const glm::dvec3 place(light.position), direction(light.direction);
  const double nearest = glm::dot(place - eye, ray), h = glm::length(eye + nearest * ray - place);
  const double inner = std::cos(glm::radians(static_cast<double>(light.inner_angle_deg)));
  const double outer = std::cos(glm::radians(static_cast<double>(light.outer_angle_deg)));
  // t = nearest + h tan u turns dt / r² into du / h.
  const auto f = [&](double u) {
    const double t = nearest + h * std::tan(u);
    double share = 1;
    if (light.kind == LightKind::spot) {
      const double cosine = glm::dot(glm::normalize(eye + t * ray - place), direction);
      const double s = std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0);
      share = s * s * (3 - 2 * s);
    }
    return share * kExtinction * std::exp(-kExtinction * (t - begin)) / h;
  };
  const auto angle = [&](double t) { return std::atan2(t - nearest, h); };
  return kAlbedo * colour * (integral(f, angle(begin), angle(end)) / (4 * pi));
}

struct Case {
  const char* name;
  Light light;
  View view;
};

Light light_of(LightKind kind, const glm::vec3& position, const glm::vec3& direction) {
  Light light{.name = "light", .kind = kind, .position = position, .direction = glm::normalize(direction)};
  light.intensity = {4.0F, 3.0F, 2.0F};
  light.inner_angle_deg = 20.0F;
  light.outer_angle_deg = 40.0F;
  return light;
}

std::vector<Case> cases() {
  const View outside{.name = "outside", .eye = {1.0F, 1.5F, 6.0F}, .target = glm::vec3(0.0F), .fov_y_deg = 40.0F};
  const View inside{.name = "inside", .eye = {-1.5F, -0.3F, 0.7F}, .target = {2.0F, 0.1F, -0.5F}, .fov_y_deg = 70.0F};
  const glm::vec3 above(0.5F, 2.5F, 0.3F), within(0.413F, 0.377F, -0.212F);
  std::vector<Case> all;
  for (const View& view : {outside, inside}) {
    all.push_back({"directional", light_of(LightKind::directional, {}, {0.3F, -1.0F, 0.2F}), view});
    all.push_back({"point above", light_of(LightKind::point, above, {0.0F, -1.0F, 0.0F}), view});
    all.push_back({"point within", light_of(LightKind::point, within, {0.0F, -1.0F, 0.0F}), view});
    all.push_back({"spot above", light_of(LightKind::spot, above, {0.1F, -1.0F, -0.2F}), view});
    all.push_back({"spot within", light_of(LightKind::spot, within, {0.5F, -0.6F, 0.4F}), view});
  }
  return all;
}

class SingleScattering : public testing::TestWithParam<Case> {};

// The remaining difference: single-precision coordinates, and the midpoint rule's Δd²/24 times the integrand's slope at
// the path's ends and at a spot's edge. With a lamp in the picture some ray passes it at 2 cm, and 6 m / 4096 is small
// against that.
TEST_P(SingleScattering, IsItsIntegral) {
  const Case& c = GetParam();
  const bool peak = c.name == std::string("point within") || c.name == std::string("spot within");
  const Values hulls{{"hulls", "16"}, {"samples", "256"}, {"sample_offset", "0.5"}, {"coordinates", "single"}};
  const Values marching{{"samples", "4096"}};
  for (const bool with_hulls : {true, false}) {
    Settings settings{.technique = with_hulls ? "sampling_hulls" : "ray_marching",
                      .values = with_hulls ? hulls : marching,
                      .view = c.view.name,
                      .width = 48,
                      .height = 36};
    settings.values.emplace_back("frame.format", "single");
    const Image image = frame(foggy(c.light, c.view), settings);
    const Camera camera{c.view, settings.width, settings.height};
    double max = 0, sum = 0, brightest = 0;
    for (int y = 0; y < settings.height; ++y) {
      for (int x = 0; x < settings.width; ++x) {
        const glm::dvec3 expected = scattered(c.light, camera, x, y);
        for (int k = 0; k < 3; ++k) {
          const double error = std::abs(static_cast<double>(image.at(x, y)[k]) - expected[k]);
          max = error > max || std::isnan(error) ? error : max;
          sum += error / (3.0 * settings.width * settings.height);
          brightest = std::max(brightest, expected[k]);
        }
      }
    }
    EXPECT_GT(brightest, 0.02) << "there must be light to compare";
    EXPECT_LT(max, peak ? 7e-4 : 5e-5) << settings.technique;
    EXPECT_LT(sum, 1e-5) << settings.technique;
  }
}

INSTANTIATE_TEST_SUITE_P(All, SingleScattering, testing::ValuesIn(cases()), [](const auto& instance) {
  std::string name = instance.param.view.name + "_" + instance.param.light.name + "_" + instance.param.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

}  // namespace
}  // namespace pellucid
