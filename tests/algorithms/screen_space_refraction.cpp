// Wyman's refraction against a sphere's closed form, and where it must be exact.
#include <cmath>
#include <initializer_list>
#include <optional>
#include <utility>

#include <gtest/gtest.h>

#include "algorithms/render_session.hpp"
#include "algorithms/scene/shapes/procedural.hpp"
#include "algorithms/shaders/optics.hpp"
#include "gl/context.hpp"

namespace pellucid {
namespace {

constexpr int kSize = 64;
constexpr double kRadius = 0.8;

Scene under_a_gradient(Mesh mesh, float ior) {
  Scene scene;
  scene.name = "glass";
  scene.meshes.push_back(std::move(mesh));
  Material glass{.name = "glass", .kind = SurfaceKind::dielectric};
  glass.ior = ior;
  glass.absorption = {0.0F, 0.4F, 0.0F};
  scene.materials.push_back(glass);
  scene.instances.push_back({.name = "solid"});
  scene.environment.zenith = {1.0F, 0.2F, 0.0F};
  scene.environment.horizon = {0.5F, 0.5F, 0.5F};
  scene.environment.ground = {0.0F, 0.9F, 1.0F};
  scene.views.push_back({.name = "front", .eye = {0.0F, 0.3F, 5.0F}, .target = glm::vec3(0.0F), .fov_y_deg = 22.0F});
  return scene;
}

Image frame(Scene scene, std::initializer_list<std::pair<const char*, const char*>> values = {}) {
  RenderSession session(std::move(scene), "screen_space_refraction", "front", kSize, kSize);
  session.assign_text("frame.format", "single");
  for (const auto& [name, value] : values)
    session.assign_text(name, value);
  gl::PassTimer timer;
  session.render(timer);
  return session.read_color();
}

// Both interfaces of a ball about the origin; nothing where the ray misses it.
std::optional<glm::dvec3> through_ball(const Scene& scene, const Camera& camera, int x, int y) {
  const glm::dvec3 eye(camera.view.eye), v = camera.ray_direction(x + 0.5, y + 0.5);
  const Material& glass = scene.materials[0];
  const double eta = static_cast<double>(glass.ior);
  const double b = glm::dot(eye, v), c = glm::dot(eye, eye) - kRadius * kRadius;
  if (b * b - c <= 0.05 * kRadius * kRadius) return std::nullopt;  // the outermost rim, where texels decide
  const glm::dvec3 entry = eye + (-b - std::sqrt(b * b - c)) * v, n1 = entry / kRadius;
  const glm::dvec3 t1 = *refracted(v, n1, 1.0 / eta);
  const double path = -2.0 * glm::dot(t1, entry);
  const glm::dvec3 n2 = (entry + path * t1) / kRadius;
  const auto sky = [&](const glm::dvec3& d) { return glm::dvec3(scene.environment.radiance(glm::vec3(d))); };
  const double in = fresnel_dielectric(-glm::dot(v, n1), 1.0 / eta), out = fresnel_dielectric(glm::dot(t1, n2), eta);
  return in * sky(reflected(v, n1)) +
         (1.0 - in) * (1.0 - out) * transmitted(glm::dvec3(glass.absorption), path) * sky(*refracted(t1, -n2, eta));
}

double mean_error_of_ball(std::initializer_list<std::pair<const char*, const char*>> values) {
  const Scene scene = under_a_gradient(make_sphere(static_cast<float>(kRadius), 256), 1.5F);
  const Camera camera{scene.views[0], kSize, kSize};
  const Image image = frame(under_a_gradient(make_sphere(static_cast<float>(kRadius), 256), 1.5F), values);
  double sum = 0;
  int count = 0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const auto expected = through_ball(scene, camera, x, y);
      if (!expected) continue;
      for (int c = 0; c < 3; ++c)
        sum += std::abs(static_cast<double>(image.at(x, y)[c]) - (*expected)[c]);
      count += 3;
    }
  }
  EXPECT_GT(count, 3 * kSize * kSize / 4);
  return sum / count;
}

// Index 1 bends nothing: d is d_V, the path through the solid is the exact one, and only absorption is seen. The torus
// is not convex: its far side is then the farthest, and d_V counts the gap between as glass, so it is given none here.
TEST(ScreenSpaceRefraction, IndexOneVanishes) {
  const gl::Context context;
  Scene scene = under_a_gradient(make_torus(0.55F, 0.22F, 64), 1.0F);
  scene.materials[0].absorption = glm::vec3(0.0F);
  Scene empty = under_a_gradient(make_sphere(0.001F, 8), 1.0F);
  empty.materials[0].absorption = glm::vec3(0.0F);
  empty.views[0].target = {0.0F, 0.0F, 0.0F};
  const Image solid = frame(std::move(scene)), sky = frame(std::move(empty));
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(solid.at(x, y)[c], sky.at(x, y)[c], 1e-5F) << x << ' ' << y;
    }
  }
}

// The method errs by its blend of depths; on a ball under a smooth sky that is a few per cent of the contrast (about
// 1), and the blend more than halves what the depth along the line of sight alone gives.
TEST(ScreenSpaceRefraction, BallNearItsClosedForm) {
  const gl::Context context;
  const double blended = mean_error_of_ball({}), view_depth = mean_error_of_ball({{"normal_depth", "false"}});
  EXPECT_LT(blended, 0.03);
  EXPECT_LT(blended, 0.67 * view_depth);
}

TEST(ScreenSpaceRefraction, MirrorAndMetalReflectTheSky) {
  const gl::Context context;
  for (const SurfaceKind kind : {SurfaceKind::mirror, SurfaceKind::metal}) {
    Scene scene = under_a_gradient(make_sphere(static_cast<float>(kRadius), 256), 1.5F);
    scene.materials[0].kind = kind;
    scene.materials[0].reflectance = {0.5F, 0.8F, 1.0F};
    scene.materials[0].metal_n = {0.5F, 1.2F, 2.3F};
    scene.materials[0].metal_k = {5.0F, 7.0F, 9.0F};
    const Camera camera{scene.views[0], kSize, kSize};
    const glm::dvec3 eye(camera.view.eye), v = camera.ray_direction(kSize / 2 + 8.5, kSize / 2 - 6.5);
    const double b = glm::dot(eye, v);
    const glm::dvec3 n = (eye + (-b - std::sqrt(b * b - glm::dot(eye, eye) + kRadius * kRadius)) * v) / kRadius;
    glm::dvec3 expected =
        glm::dvec3(scene.materials[0].reflectance) * glm::dvec3(scene.environment.radiance(glm::vec3(reflected(v, n))));
    if (kind == SurfaceKind::metal) {
      expected *= fresnel_metal(-glm::dot(v, n), glm::dvec3(scene.materials[0].metal_n),
                                glm::dvec3(scene.materials[0].metal_k));
    }
    const Image image = frame(std::move(scene));
    // The sphere has 256 segments: its normals are interpolated, within a thousandth.
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(static_cast<double>(image.at(kSize / 2 + 8, kSize / 2 - 7)[c]), expected[c], 2e-3);
  }
}

}  // namespace
}  // namespace pellucid
