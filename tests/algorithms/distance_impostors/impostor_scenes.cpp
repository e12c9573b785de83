// Distance impostors and environment mapping on scenes whose pixels have closed forms, and where they are easily wrong.
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/algorithms/distance_impostors/impostor_rooms.hpp"
#include "tests/algorithms/rendered.hpp"

namespace pellucid {
namespace {

using test::Settings;
using test::Values;

Material mirror() {
  return {.name = "mirror", .kind = SurfaceKind::mirror, .reflectance = {0.9F, 0.8F, 0.7F}};
}
Material glass(float ior) {
  return {.name = "glass", .kind = SurfaceKind::dielectric, .ior = ior};
}

struct Frame {
  Image image;
  Camera camera;
  nlohmann::json errors = nlohmann::json::object();
};
Frame draw(Scene scene, const std::string& technique, const Values& values, const std::string& view = "front",
           bool errors = false) {
  RenderSession session = test::start(std::move(scene), {technique, values, view, 128, 128});
  gl::PassTimer timer;
  session.render(timer);
  Frame frame{session.read_color(), session.camera()};
  if (errors) session.technique().native_errors(frame.errors);
  return frame;
}

struct Errors {
  double mean = 0, worst = 0;
  int pixels = 0;
};
// Over the pixels that see the ball well inside its outline, where `expected` has a value.
Errors compare(const Frame& frame, const std::function<std::optional<glm::dvec3>(const glm::dvec3& V)>& expected) {
  Errors errors;
  for (int y = 0; y < frame.camera.height; ++y) {
    for (int x = 0; x < frame.camera.width; ++x) {
      const auto value = expected(frame.camera.ray_direction(x + 0.5, y + 0.5));
      if (!value) continue;
      const float* pixel = frame.image.at(x, y);
      for (int c = 0; c < 3; ++c) {
        const double error = std::abs(static_cast<double>(pixel[c]) - (*value)[c]);
        errors.mean += error;
        errors.worst = std::max(errors.worst, std::isnan(error) ? 1e9 : error);
      }
      ++errors.pixels;
    }
  }
  errors.mean /= 3 * std::max(errors.pixels, 1);
  return errors;
}

// The ball's pixels with a cosine of incidence above 0.25.
std::optional<glm::dvec3> point_on_ball(const Frame& frame, const glm::dvec3& V, const glm::dvec3& ball) {
  const auto x = test::meet_ball(glm::dvec3(frame.camera.view.eye), V, ball);
  if (!x || -glm::dot(V, (*x - ball) / test::kBallRadius) < 0.25) return std::nullopt;
  return x;
}

TEST(DistanceImpostors, AMirrorBallInARoundRoom) {
  for (const glm::vec3& ball : {glm::vec3(0), glm::vec3(1.2F, -0.6F, -0.5F)}) {
    const glm::dvec3 middle(ball);
    const Values values{{"reference_point", "scene"}, {"iterations", "6"}};
    const Frame frame = draw(test::round_room(mirror(), ball), "distance_impostors", values);
    const auto expected = [&](const glm::dvec3& V) -> std::optional<glm::dvec3> {
      const auto x = point_on_ball(frame, V, middle);
      if (!x) return std::nullopt;
      return glm::dvec3(0.9, 0.8, 0.7) * test::room_light(*x, reflected(V, (*x - middle) / test::kBallRadius));
    };
    const Errors errors = compare(frame, expected);
    EXPECT_GT(errors.pixels, 1000);
    EXPECT_LT(errors.mean, 0.0015);
    EXPECT_LT(errors.worst, 0.012);
    // The classical map is far off beside the reference point, and its sphere proxy is exact in a round room.
    const Frame classical = draw(test::round_room(mirror(), ball), "environment_map", {{"reference_point", "scene"}});
    EXPECT_GT(compare(classical, expected).mean, 8 * errors.mean);
    const Frame proxy = draw(test::round_room(mirror(), ball), "environment_map",
                             {{"reference_point", "scene"}, {"parallax", "sphere"}, {"proxy_radius_m", "4"}});
    EXPECT_LT(compare(proxy, expected).mean, 0.0015);
  }
}

TEST(DistanceImpostors, OneAndTwoRefractionsOfABall) {
  for (const float ior : {1.1F, 1.5F, 0.8F}) {
    const glm::vec3 ball(0.4F, 0.1F, -0.3F);
    const glm::dvec3 middle(ball);
    for (const int bounces : {1, 2}) {
      const Values values{{"iterations", "8"},
                          {"refractor_size", "512"},
                          {"internal_reflections", "1"},
                          {"bounces", std::to_string(bounces)}};
      const Frame frame = draw(test::round_room(glass(ior), ball), "distance_impostors", values);
      const auto eta = static_cast<double>(ior);
      const Errors errors = compare(frame, [&](const glm::dvec3& V) -> std::optional<glm::dvec3> {
        const auto x = point_on_ball(frame, V, middle);
        if (!x) return std::nullopt;
        const glm::dvec3 n = (*x - middle) / test::kBallRadius;
        const double cosine = -glm::dot(V, n);
        const double share = fresnel_dielectric(cosine, 1 / eta);
        const auto R = refracted(V, n, 1 / eta);
        // At the critical angle the two sides of an edge differ.
        if (!R || -glm::dot(*R, n) < 0.15) return std::nullopt;
        const glm::dvec3 within = bounces == 1 ? test::room_light(*x, *R) : test::light_through(*x, *R, eta, 1, middle);
        return share * test::room_light(*x, reflected(V, n)) + (1 - share) * within;
      });
      EXPECT_GT(errors.pixels, 600) << ior;
      EXPECT_LT(errors.mean, 0.004) << "index " << ior << ", " << bounces << " refractions";
      EXPECT_LT(errors.worst, 0.06) << "index " << ior << ", " << bounces << " refractions";
    }
  }
}

// From the centre all rays leave straight, and go to and fro on their diameter.
TEST(DistanceImpostors, TheEyeInsideARefractor) {
  const Frame frame = draw(test::round_room(glass(1.5F)), "distance_impostors",
                           {{"internal_reflections", "2"}, {"iterations", "6"}}, "inside");
  const Errors errors = compare(frame, [&](const glm::dvec3& V) -> std::optional<glm::dvec3> {
    return test::light_through(glm::dvec3(0), V, 1.5, 2, glm::dvec3(0));
  });
  EXPECT_EQ(errors.pixels, 128 * 128);
  EXPECT_LT(errors.mean, 0.003);
  EXPECT_LT(errors.worst, 0.03);
}

TEST(DistanceImpostors, AbsorptionFollowsThePathInside) {
  Material colored = glass(1.0F);  // nothing bends: the path is a chord
  colored.absorption = {0.2F, 1.0F, 3.0F};
  const Frame frame =
      draw(test::round_room(colored), "distance_impostors", {{"iterations", "8"}, {"refractor_size", "512"}});
  const Errors errors = compare(frame, [&](const glm::dvec3& V) -> std::optional<glm::dvec3> {
    const auto x = point_on_ball(frame, V, glm::dvec3(0));
    if (!x) return std::nullopt;
    const glm::dvec3 end = test::leave_sphere(*x, V, test::kBallRadius);
    return transmitted({0.2, 1, 3}, glm::distance(*x, end)) * test::room_light(end, V);
  });
  EXPECT_LT(errors.mean, 0.002);
  EXPECT_LT(errors.worst, 0.02);
}

TEST(DistanceImpostors, AMetalReflectsByItsComplexIndex) {
  const Material metal{
      .name = "metal", .kind = SurfaceKind::metal, .metal_n = {0.5F, 1.1F, 2.3F}, .metal_k = {5.0F, 7.0F, 9.0F}};
  const Frame frame = draw(test::round_room(metal), "distance_impostors", {});
  const Errors errors = compare(frame, [&](const glm::dvec3& V) -> std::optional<glm::dvec3> {
    const auto x = point_on_ball(frame, V, glm::dvec3(0));
    if (!x) return std::nullopt;
    const glm::dvec3 n = *x / test::kBallRadius;
    return fresnel_metal(-glm::dot(V, n), {0.5, 1.1, 2.3}, {5, 7, 9}) * test::room_light(*x, reflected(V, n));
  });
  EXPECT_LT(errors.mean, 0.002);
}

// However the cube maps are drawn and stored, the picture is the same.
TEST(DistanceImpostors, DrawsAndStoresMapsAlike) {
  const auto image = [](const Values& values) {
    return draw(test::round_room(mirror(), {0.9F, 0, 0}), "distance_impostors", values).image;
  };
  const Image usual = image({{"cube_size", "128"}});
  EXPECT_LT(test::difference(usual, image({{"cube_size", "128"}, {"cube_pass", "faces"}})).max, 0.002);
  EXPECT_LT(test::difference(usual, image({{"cube_size", "128"}, {"cube_pass", "geometry"}})).max, 0.002);
  EXPECT_LT(test::difference(usual, image({{"cube_size", "128"}, {"distance", "alpha"}})).max, 0.002);
  EXPECT_LT(test::difference(usual, image({{"cube_size", "128"}, {"cube_format", "single"}})).mean, 0.002);
  if (epoxy_has_gl_extension("GL_ARB_shader_viewport_layer_array")) {
    EXPECT_LT(test::difference(usual, image({{"cube_size", "128"}, {"cube_pass", "vertex"}})).max, 0.002);
  }
}

TEST(DistanceImpostors, NativeErrorsFallWithIterations) {
  double before = 1e9;
  for (const char* iterations : {"-1", "0", "2", "8"}) {
    const Frame frame =
        draw(test::round_room(mirror(), {1.5F, 0.3F, -0.8F}), "distance_impostors",
             {{"reference_point", "scene"}, {"iterations", iterations}, {"cube_format", "single"}}, "front", true);
    EXPECT_GT(frame.errors.at("object_pixels").get<int>(), 1000);
    EXPECT_EQ(frame.errors.at("hidden_share").get<double>(), 0);  // a round room hides nothing
    EXPECT_EQ(frame.errors.at("escaped_share").get<double>(), 0);
    const double error = frame.errors.at("hit_error_m_mean").get<double>();
    EXPECT_LT(error, 1.05 * before) << iterations;  // in the end the texels' size is what is left
    before = error;
  }
  EXPECT_LT(before, 0.003);
}

// A ball half out of the room, and one quite out of it: no NaN, whatever the picture is worth.
TEST(DistanceImpostors, AnObjectAtOrBeyondTheWalls) {
  for (const float x : {4.0F, 9.0F}) {
    for (const Material& material : {mirror(), glass(1.5F)}) {
      for (const char* scheme : {"secant", "false_position", "linear"}) {
        if (x == 4.0F && scheme != std::string("false_position")) continue;
        Scene scene = test::round_room(material, {x, 0, 0});
        scene.views[0].eye = {x - 2.2F, 0.5F, 1.0F};
        const Frame frame = draw(std::move(scene), "distance_impostors",
                                 {{"reference_point", "scene"}, {"iterations", "8"}, {"scheme", scheme}});
        EXPECT_EQ(test::not_finite(frame.image), 0) << x << " " << scheme;
      }
    }
  }
}

TEST(DistanceImpostors, WarnsOfARefractorThatIsNotStarShaped) {
  Scene scene = test::round_room(glass(1.3F));
  scene.meshes[1] = make_torus(0.6F, 0.2F, 64);
  scene.meshes[1].name = "ring";
  const Frame frame = draw(std::move(scene), "distance_impostors", {}, "front", true);
  EXPECT_EQ(test::not_finite(frame.image), 0);
  const std::string warning = frame.errors.at("warnings").get<std::string>();
  EXPECT_NE(warning.find("'ring' is not star-shaped"), std::string::npos) << warning;
  const Frame ball = draw(test::round_room(glass(1.3F)), "distance_impostors", {}, "front", true);
  EXPECT_FALSE(ball.errors.contains("warnings"));
}

TEST(DistanceImpostors, RefusesASceneWithoutSuchAnObject) {
  Scene scene = test::round_room(mirror());
  scene.materials[1].kind = SurfaceKind::lambertian;
  for (const char* technique : {"distance_impostors", "environment_map"}) {
    RenderSession session = test::start(test::round_room(mirror()), {technique, {}, "front", 16, 16});
    session.scene().materials[1].kind = SurfaceKind::lambertian;
    EXPECT_THROW(session.prepare(), InputError);
  }
}

// Two mirrors show each other, and each other's picture of themselves.
TEST(DistanceImpostors, ObjectsSeeEachOther) {
  const auto scene = [] {
    Scene two = test::round_room(mirror(), {-0.9F, 0, 0});
    two.instances.push_back(
        {.name = "other", .mesh = 1, .material = 1, .to_world = glm::translate(glm::mat4(1), glm::vec3(0.9F, 0, 0))});
    two.views[0].target = glm::vec3(0);
    two.views[0].fov_y_deg = 60;
    return two;
  };
  test::use_context();
  RenderSession session = test::start(scene(), {"distance_impostors", {}, "front", 128, 128});
  const SurfaceLayer truth = trace_surfaces(session.scene(), session.camera());
  double before = 1e9;
  for (const char* rounds : {"0", "1", "2"}) {
    const Frame frame = draw(scene(), "distance_impostors", {{"mutual", rounds}, {"iterations", "6"}});
    const double error = test::difference(frame.image, truth.radiance).mean;
    EXPECT_LT(error, before) << rounds;
    before = error;
  }
  EXPECT_LT(before, 0.006);
}

int refreshes(const Values& values, int frames, bool move) {
  RenderSession session = test::start(load_scene("mirror_room"), {"distance_impostors", values, "", 32, 32});
  session.assign_text("cube_size", "64");
  gl::PassTimer timer;
  for (int i = 0; i < frames; ++i) {
    if (move) session.assign("scene.ball_x", Value(0.1 * i));
    session.render(timer);
  }
  nlohmann::json errors = nlohmann::json::object();
  session.technique().native_errors(errors);
  EXPECT_GT(errors.at("cube_ms").get<double>(), 0);
  const double per_frame = errors.at("cube_ms_per_frame").get<double>(), each = errors.at("cube_ms").get<double>();
  EXPECT_NEAR(per_frame * frames, each * errors.at("cube_refreshes").get<double>(), 1e-6 * each);
  return errors.at("cube_refreshes").get<int>();
}

TEST(DistanceImpostors, RefreshesMapsWhenTheyAreDue) {
  EXPECT_EQ(refreshes({{"refresh", "once"}}, 7, true), 1);
  EXPECT_EQ(refreshes({{"refresh", "frames"}}, 7, false), 7);
  EXPECT_EQ(refreshes({{"refresh", "frames"}, {"refresh_frames", "3"}}, 7, true), 3);
  EXPECT_EQ(refreshes({{"refresh", "interval"}, {"refresh_ms", "0"}}, 4, false), 4);
  EXPECT_EQ(refreshes({{"refresh", "interval"}, {"refresh_ms", "60000"}}, 4, false), 1);
  EXPECT_EQ(refreshes({{"refresh", "movement"}, {"refresh_distance_m", "0.25"}}, 7, true), 3);
  EXPECT_EQ(refreshes({{"refresh", "movement"}, {"refresh_distance_m", "0.25"}}, 7, false), 1);
}

}  // namespace
}  // namespace pellucid
