// Why the hits of distance impostors are wrong: the classes against exact rays.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "algorithms/local_cube_maps/hit_errors.hpp"
#include "tests/algorithms/distance_impostors/impostor_rooms.hpp"
#include "tests/algorithms/rendered.hpp"

namespace pellucid::local_cube_maps {
namespace {

constexpr std::array kClasses{"right", "other_surface", "hidden", "unconverged"};
constexpr int kCubeSize = 256;

TEST(HitClasses, FollowFromWhereAHitLies) {
  const double texel_deg = std::atan(2.0 / kCubeSize) * 180 / std::numbers::pi;
  const auto of = [](const HitPlace& place) { return classify(place, kCubeSize); };
  EXPECT_EQ(of({1.9 * texel_deg, 1, 0, false}), HitClass::right);
  EXPECT_EQ(of({1.9 * texel_deg, 1.5, 1, false}), HitClass::right);  // its light is that of the true hit
  EXPECT_EQ(of({2.1 * texel_deg, 1.005, 0.3, false}), HitClass::other_surface);
  EXPECT_EQ(of({2.1 * texel_deg, 1.02, 0.3, false}), HitClass::unconverged);
  EXPECT_EQ(of({2.1 * texel_deg, 1.005, 0.01, false}), HitClass::unconverged);  // has slid along the right surface
  EXPECT_EQ(of({0, 1, 0, true}), HitClass::hidden);
  EXPECT_EQ(of({1.1 * texel_deg, 1, 0, false}), HitClass::right);
  EXPECT_EQ(classify({1.1 * texel_deg, 1, 0.3, false}, 2 * kCubeSize), HitClass::other_surface);  // smaller texels
}

/// A room and a box in it, from inside the one and outside the other.
struct Box {
  glm::dvec3 middle, half;
  // Where the ray enters and where it leaves.
  std::pair<double, double> cross(const glm::dvec3& x, const glm::dvec3& R) const {
    const glm::dvec3 a = (middle - half - x) / R, b = (middle + half - x) / R;
    const glm::dvec3 low = glm::min(a, b), high = glm::max(a, b);
    return {std::max({low.x, low.y, low.z}), std::min({high.x, high.y, high.z})};
  }
};
const Box kRoom{glm::dvec3(0), glm::dvec3(4, 3, 3.5)};
const Box kPillar{glm::dvec3(1.3, -1, -1.2), glm::dvec3(0.5, 1.4, 0.6)};
const glm::dvec3 kBall(2.6, -0.4, 0.2);

struct Crossing {
  double distance;
  glm::dvec3 normal;
};
Crossing nearest(const glm::dvec3& x, const glm::dvec3& R) {
  const auto [in, out] = kPillar.cross(x, R);
  const bool pillar = in > 1e-9 && in < out;
  const double distance = pillar ? in : kRoom.cross(x, R).second;
  const Box& box = pillar ? kPillar : kRoom;
  const glm::dvec3 place = (x + distance * R - box.middle) / box.half, size = glm::abs(place);
  const double most = std::max({size.x, size.y, size.z});
  return {distance, glm::dvec3(glm::equal(size, glm::dvec3(most)))};
}

Scene room_with_pillar() {
  const Material mirror{.name = "mirror", .kind = SurfaceKind::mirror, .reflectance = glm::vec3(1)};
  Scene scene = test::round_room(mirror, glm::vec3(kBall));
  scene.meshes[0] = make_box(glm::vec3(2.0 * kRoom.half));
  scene.meshes.push_back(make_box(glm::vec3(2.0 * kPillar.half)));
  scene.instances.push_back({.name = "pillar",
                             .mesh = 2,
                             .material = 0,
                             .to_world = glm::translate(glm::mat4(1), glm::vec3(kPillar.middle))});
  scene.views[0].eye = {0.4F, 0.9F, 3.0F};
  scene.views[0].fov_y_deg = 50;
  return scene;
}

struct Classified {
  std::vector<NativeMap> maps;
  nlohmann::json errors = nlohmann::json::object();
  Camera camera;
};
Classified draw(Scene scene, test::Values values) {
  values.insert(values.end(),
                {{"reference_point", "point"}, {"cube_size", std::to_string(kCubeSize)}, {"cube_format", "single"}});
  RenderSession session = test::start(std::move(scene), {"distance_impostors", values, "front", 160, 160});
  gl::PassTimer timer;
  session.render(timer);
  Classified out{session.technique().native_maps(), nlohmann::json::object(), session.camera()};
  session.technique().native_errors(out.errors);
  return out;
}

const NativeMap& find(const Classified& drawn, std::string_view name) {
  return *std::find_if(drawn.maps.begin(), drawn.maps.end(), [&](const NativeMap& map) { return map.name == name; });
}

// A box between the reference point and a wall, and beside the ball: the class of each pixel, by exact rays and
// distances.
TEST(HitClasses, AreThoseOfExactRaysPastABox) {
  const Classified drawn = draw(room_with_pillar(), {{"iterations", "6"}});
  const Image& classes = find(drawn, "hit_class").values;
  std::array<int, 4> exact{}, ours{};
  int pixels = 0, differ = 0;
  for (int y = 0; y < drawn.camera.height; ++y) {
    for (int x = 0; x < drawn.camera.width; ++x) {
      const glm::dvec3 V = drawn.camera.ray_direction(x + 0.5, y + 0.5);
      const auto at = test::meet_ball(glm::dvec3(drawn.camera.view.eye), V, kBall);
      const float shown = *classes.at(x, y);
      if (!at || !std::isfinite(shown)) continue;
      const glm::dvec3 R = glm::reflect(V, (*at - kBall) / test::kBallRadius);
      const auto distance = [](const glm::dvec3& d) { return nearest({}, glm::normalize(d)).distance; };
      const Crossing truth = nearest(*at, R);
      const glm::dvec3 q = *at + truth.distance * R;
      const glm::dvec3 l = find_hit(*at, R, distance, {6, Scheme::false_position, 64});
      const double turn = std::atan2(glm::length(glm::cross(l, q)), glm::dot(l, q)) * 180 / std::numbers::pi;
      const HitPlace place{turn, glm::length(l) / distance(l), std::abs(glm::dot(truth.normal, l - q)) / glm::length(q),
                           distance(q) < 0.999 * glm::length(q)};
      const auto expected = static_cast<std::size_t>(classify(place, kCubeSize));
      ++pixels;
      ++exact[expected];
      ++ours[static_cast<std::size_t>(shown)];
      if (static_cast<std::size_t>(shown) != expected) ++differ;
    }
  }
  ASSERT_GT(pixels, 2000);
  for (std::size_t c = 0; c < kClasses.size(); ++c) {
    EXPECT_GT(exact[c], 0.004 * pixels) << kClasses[c] << ": the scene has all of them";
    EXPECT_NEAR(ours[c], exact[c], 0.02 * pixels) << kClasses[c];
  }
  EXPECT_LT(differ, 0.05 * pixels);  // edges of the box are as wide as a texel in the map
}

TEST(HitClasses, ExcludeOneAnotherAndAddUp) {
  for (const char* scheme : {"false_position", "linear"}) {
    const Classified drawn = draw(room_with_pillar(), {{"iterations", "12"}, {"scheme", scheme}});
    double shares = 0, errors = 0;
    for (const char* name : kClasses) {
      const std::string prefix = std::string("hits_") + name;
      shares += drawn.errors.at(prefix + "_share").get<double>();
      errors += drawn.errors.at(prefix + "_error_share").get<double>();
    }
    EXPECT_NEAR(shares, 1, 1e-9);
    EXPECT_NEAR(errors, 1, 1e-6);
    EXPECT_EQ(drawn.errors.at("hits_hidden_share"), drawn.errors.at("hidden_share"));
    EXPECT_LT(drawn.errors.at("hits_right_error_m_mean").get<double>(), 0.05);
    // The search over the whole ray takes the first surface; Eq. 6 any of them.
    const double other = drawn.errors.at("hits_other_surface_share").get<double>();
    if (scheme == std::string("linear"))
      EXPECT_LT(other, 0.01);
    else
      EXPECT_GT(other, 0.02);
  }
}

TEST(HitClasses, ARoundRoomHasButRightHits) {
  const Material mirror{.name = "mirror", .kind = SurfaceKind::mirror, .reflectance = glm::vec3(1)};
  const Classified drawn = draw(test::round_room(mirror, {1.2F, -0.6F, -0.5F}), {{"iterations", "8"}});
  EXPECT_GT(drawn.errors.at("hits_right_share").get<double>(), 0.995);
  EXPECT_FALSE(drawn.errors.contains("hits_hidden_error_m_mean"));
}

// Statistics and maps are of one computation.
TEST(NativeMaps, OfDistanceImpostorsHoldWhatTheStatisticsSay) {
  const Classified drawn = draw(room_with_pillar(), {{"iterations", "3"}});
  ASSERT_EQ(drawn.maps.size(), 3U);
  for (const char* name : {"hit_error_m", "direction_error_deg"}) {
    const NativeMap& map = find(drawn, name);
    EXPECT_EQ(map.values.width, 160);
    double sum = 0, count = 0;
    for (const float v : map.values.pixels) {
      if (!std::isfinite(v)) continue;
      sum += static_cast<double>(v);
      ++count;
    }
    EXPECT_EQ(count, drawn.errors.at("object_pixels").get<double>()) << name;  // all hit something
    EXPECT_NEAR(drawn.errors.at(std::string(name) + "_mean").get<double>(), sum / count, 1e-9) << name;
  }
  const NativeMap& classes = find(drawn, "hit_class");
  ASSERT_EQ(classes.classes.size(), kClasses.size());
  for (std::size_t c = 0; c < kClasses.size(); ++c) {
    EXPECT_EQ(classes.classes[c], kClasses[c]);
    const auto count = std::count(classes.values.pixels.begin(), classes.values.pixels.end(), static_cast<float>(c));
    EXPECT_NEAR(drawn.errors.at(std::string("hits_") + kClasses[c] + "_share").get<double>(),
                static_cast<double>(count) / drawn.errors.at("object_pixels").get<double>(), 1e-9);
  }
}

}  // namespace
}  // namespace pellucid::local_cube_maps
