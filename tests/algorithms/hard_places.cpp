// The media techniques with cameras and lights in odd places.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tests/algorithms/hard_cases.hpp"

namespace pellucid {
namespace {

using namespace test;

class HardPlaces : public HardCases {};
INSTANTIATE_TEST_SUITE_P(All, HardPlaces, testing::ValuesIn(contenders()),
                         [](const auto& instance) { return std::string(instance.param.name); });

// ---- cameras ----

// In uniform fog only rounding is left, and with slices a slab of 4.8 m / 2048 at either end of the path: an opacity of
// 1.6e-3 or, where a ray runs at 45 degrees to object-aligned slices, half as much again.
TEST_P(HardPlaces, CameraInsideTheVolume) {
  for (const char* view : {"inside", "straddling"}) {
    auto make = [] { return fog_box_with_ball({4, 4, 4}, 0.75F, 0.9F); };
    expect_near(make, c.slices ? 5e-3 : 2e-4, c.slices ? 4e-4 : 5e-6, view);
    expect_finite(make, c, view);
  }
}

// The eye in the plane of a face, in an edge's line, on a face and in a corner: the middle pixels' rays run along
// faces, where the ray's way through the box is 0 / 0. On one side of them is fog, on the other none.
TEST_P(HardPlaces, CameraInAFacesPlane) {
  for (const glm::vec3& eye :
       {glm::vec3(-1.0F, 0.0F, 4.0F), glm::vec3(-1.0F, -1.0F, 4.0F), glm::vec3(-1.0F, -1.0F, 1.0F),
        glm::vec3(0.0F, 0.0F, 1.0F), glm::vec3(-1.0F, 0.0F, 0.0F)}) {
    auto make = [&] {
      Scene scene = aligned_fog();
      scene.ambient = glm::vec3(1.0F);
      scene.views = {view_at("face", eye, eye - glm::vec3(0.0F, 0.0F, 1.0F), 60.0F)};
      return scene;
    };
    for (const Values& values : {c.least, c.fine}) {
      Settings s = settings(c, values, "face");
      s.width = 45;  // odd numbers: the middle pixel's ray is parallel to the z axis
      const Image image = frame(make(), s);
      ASSERT_EQ(not_finite(image), 0) << eye.x << ", " << eye.y << ", " << eye.z;
      for (const float v : image.pixels) {
        ASSERT_GE(v, 0.0F);
        ASSERT_LE(v, 1.0F) << "brighter than its source";
      }
      if (eye.x == 0) continue;
      EXPECT_EQ(image.at(21, 12)[0], 0.0F);
      if (!c.slices || values == c.fine) {  // a single slice lies beside some of these rays
        EXPECT_GT(image.at(23, 12)[0], 0.1F);
      }
    }
  }
}

// A closed ball about the eye: all that is seen is its inner side through the fog before it.
TEST_P(HardPlaces, CameraInsideAnOpaqueObject) {
  auto make = [](float radius, float near_m) {
    Scene scene = aligned_fog(0.8F, {4, 4, 4});
    scene.ambient = {0.25F, 0.5F, 1.0F};
    scene.meshes.push_back(make_sphere(radius, 128));
    scene.materials.push_back({.name = "grey", .albedo = glm::vec3(0.4F)});
    scene.instances.push_back({.name = "ball", .to_world = glm::translate(glm::mat4(1.0F), {0.1F, 0.2F, 0.3F})});
    scene.views = {view_at("in ball", {0.1F, 0.2F, 0.3F}, {0.1F, 0.2F, -5.0F}, 90.0F, near_m)};
    scene.environment.zenith = scene.environment.horizon = scene.environment.ground = glm::vec3(5.0F);
    return scene;
  };
  Scene around = make(0.5F, 0.1F);
  const Camera camera{around.views[0], 60, 45};
  const glm::dvec3 ambient(around.ambient), albedo(around.volume->albedo);
  const Image image = frame(std::move(around), settings(c, c.fine, ""));
  double worst = 0;
  for (int y = 0; y < 45; ++y) {
    for (int x = 0; x < 60; ++x) {
      // From the near plane to the ball: the wall's own radiance is that of the ambient light times its albedo.
      const double path = 0.5 - 0.1 / -camera.ray_direction(x + 0.5, y + 0.5).z;
      const double clear = std::exp(-0.8 * path);
      for (int channel = 0; channel < 3; ++channel) {
        const double expected = ambient[channel] * (albedo[channel] * (1 - clear) + 0.4 * clear);
        worst = std::max(worst, std::abs(static_cast<double>(image.at(x, y)[channel]) - expected));
      }
    }
  }
  // The ball's facets lie up to 0.3 mm within its radius. Slices: two slabs of 1.2 m / 2048 more or less.
  EXPECT_LT(worst, c.slices ? 2e-3 : 3e-4);

  // The near plane cuts the ball: seen through it where it is nearer, as if it were not there.
  expect_near([&] { return make(0.4F, 0.3F); }, c.slices ? 5e-3 : 2e-4, c.slices ? 1e-3 : 5e-5, "");
  const Image without = frame(
      [&] {
        Scene scene = make(0.5F, 0.3F);
        scene.instances.clear();
        return scene;
      }(),
      settings(c, c.fine, ""));
  EXPECT_EQ(difference(frame(make(0.2F, 0.3F), settings(c, c.fine, "")), without).max, 0.0)
      << "a ball within the near plane cannot be seen";
  for (const float radius : {0.5F, 0.4F, 0.2F})
    expect_finite([&] { return make(radius, 0.3F); }, c, "");
}

// The same for a lamp outside the ball, which lights only the ball's outside: the inner wall is dark with shadows, and
// two-sided shading shows the lit wall's back without them.
TEST_P(HardPlaces, InsideOfAnObjectIsShadedTwoSided) {
  auto make = [](bool shadow) {
    Scene scene = aligned_fog(0.0F);
    scene.meshes.push_back(make_sphere(0.5F, 64));
    scene.materials.push_back({.name = "grey", .albedo = glm::vec3(0.4F)});
    scene.instances.push_back({.name = "ball"});
    scene.lights.push_back(lamp({0.0F, 0.0F, 3.0F}, 10.0F, LightKind::point, shadow));
    scene.views = {view_at("in ball", glm::vec3(0.0F), {0.0F, 0.0F, -5.0F})};
    return scene;
  };
  // The wall straight ahead faces the lamp from 3.5 m: I / r² · albedo / π.
  const double lit = 10.0 / (3.5 * 3.5) * 0.4 / std::numbers::pi;
  EXPECT_NEAR(frame(make(false), settings(c, c.least, "")).at(30, 22)[0], lit, 2e-3 * lit) << "facets";
  EXPECT_NEAR(frame(make(true), settings(c, c.least, "")).at(30, 22)[0], 0.0, 0.03 * lit) << "light bleeding";
}

TEST_P(HardPlaces, VolumeBehindTheCamera) {
  auto make = [] {
    Scene scene = fog_box_with_ball({4, 4, 4}, 1.0F, 5.0F);
    scene.lights.push_back(lamp({0.6F, 0.9F, 0.4F}, 2.0F, LightKind::point, true));
    return scene;
  };
  for (const Values& values : {c.least, c.fine}) {
    const Image image = frame(make(), settings(c, values, "behind"));
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        ASSERT_EQ(image.at(x, y)[0], 0.9F) << x << ", " << y;
        ASSERT_EQ(image.at(x, y)[1], 0.3F);
        ASSERT_EQ(image.at(x, y)[3], 1.0F) << "transmittance";
      }
    }
  }
  expect_finite(make, c, "behind");
}

// A wall before the volume hides it to the last bit.
TEST_P(HardPlaces, VolumeBehindAWall) {
  auto make = [](bool volume) {
    Scene scene = fog_box({4, 4, 4}, 1.0F, volume ? 5.0F : 0.0F);
    if (!volume) scene.volume->to_world[3] += glm::vec4(0.0F, 0.0F, 500.0F, 0.0F);
    scene.meshes.push_back(make_box({20.0F, 20.0F, 0.1F}));
    scene.materials.push_back({.name = "grey", .albedo = glm::vec3(0.4F)});
    scene.instances.push_back({.name = "wall", .to_world = glm::translate(glm::mat4(1.0F), {0.0F, 0.0F, 4.0F})});
    scene.lights.push_back(lamp({0.6F, 0.9F, 0.4F}, 20.0F));
    return scene;
  };
  for (const Values& values : {c.least, c.fine})
    EXPECT_EQ(difference(frame(make(true), settings(c, values)), frame(make(false), settings(c, values))).max, 0.0);
}

// ---- lights ----

// 1/r² peaks between the points of a path that passes the lamp 4 cm away or more: half a step of 4.8 m / 1024 is small
// against it. With shadows the error is that of the shadow map, whose texel is 1/512 of a face and whose penumbra is
// some texels wide: 4 cm at 2 m from the lamp.
TEST_P(HardPlaces, LightInsideTheVolume) {
  for (const LightKind kind : {LightKind::point, LightKind::spot}) {
    for (const bool shadow : {false, true}) {
      auto make = [&] {
        Scene scene = fog_box_with_ball({4, 4, 4}, 1.0F, 0.5F);
        scene.lights.push_back(lamp({0.62F, 0.93F, 0.41F}, 1.0F, kind, shadow));
        scene.lights[0].direction = glm::normalize(glm::vec3(-0.6F, -1.0F, -0.3F));
        scene.lights[0].outer_angle_deg = 50.0F;
        return scene;
      };
      for (const char* view : {"front", "inside"}) {
        SCOPED_TRACE(testing::Message() << (kind == LightKind::spot ? "spot" : "point") << (shadow ? ", shadow" : ""));
        expect_near(make,
                    shadow     ? 3e-2
                    : c.slices ? 7e-3
                               : 5e-4,
                    shadow     ? 1.5e-3
                    : c.slices ? 4e-4
                               : 4e-5,
                    view, {{"shadow.size", "1024"}, {"shadow.bleeding", "0.1"}});
        expect_finite(make, c, view);
      }
    }
  }
}

// The lamp stands where the middle pixel's ray meets a sampling point or a slice: no division by zero, and a point so
// bright that no frame holds it is as bright as a frame can be.
TEST_P(HardPlaces, LightOnASamplingPoint) {
  for (const LightKind kind : {LightKind::point, LightKind::spot}) {
    for (const bool shadow : {false, true}) {
      for (const char* format : {"half", "single"}) {
        SCOPED_TRACE(testing::Message() << (kind == LightKind::spot ? "spot" : "point")
                                        << (shadow ? ", shadow, " : ", ") << format);
        Scene scene = aligned_fog();
        scene.lights.push_back(lamp(glm::vec3(0.0F), 1.0F, kind, shadow));
        Settings s = settings(c, c.least);
        if (!c.slices) s.values.emplace_back("sample_offset", "0.5");
        if (c.technique == "sampling_hulls") s.values.emplace_back("coordinates", "single");
        s.values.emplace_back("frame.format", format);
        s.width = 45;  // odd numbers: the middle pixel's ray is the z axis
        const Image image = frame(std::move(scene), s);
        EXPECT_EQ(not_finite(image), 0);
        if (kind == LightKind::point && c.name != std::string("jittered_marching")) {
          // 0.9 E / 4π of the greatest irradiance, 65504 π, times the opacity of 2 m of fog of 0.5 per metre.
          const double expected = 0.9 * 65504 / 4 * -std::expm1(-1.0);
          EXPECT_NEAR(image.at(22, 22)[0], expected, 1e-3 * expected);
        }
        EXPECT_LT(image.at(0, 22)[0], 1.0F) << "beside it";
      }
    }
  }
}

// So narrow a spot that its two cosines are one float: along its axis there is light, beside it none.
TEST_P(HardPlaces, SpotOfAHairsBreadth) {
  Scene scene = aligned_fog();
  Light spot = lamp({0.0F, 0.0F, 2.0F}, 1.0F, LightKind::spot);
  spot.direction = {0.0F, 0.0F, -1.0F};
  spot.inner_angle_deg = 0.001F;
  spot.outer_angle_deg = 0.002F;
  scene.lights.push_back(spot);
  Settings s = settings(c, c.fine);
  s.width = 45;  // odd numbers: the middle pixel's ray is the spot's axis
  const Image image = frame(std::move(scene), s);
  EXPECT_EQ(not_finite(image), 0);
  EXPECT_GT(image.at(22, 22)[0], 1e-3F);
  EXPECT_EQ(image.at(12, 22)[0], 0.0F);
}

// A lamp at the eye, on the box's face, at its corner and inside an opaque object.
TEST_P(HardPlaces, LightsWhereSomethingElseIs) {
  for (const glm::vec3& place :
       {glm::vec3(0.0F, 0.0F, 4.0F), glm::vec3(0.0F, 0.0F, 1.0F), glm::vec3(1.0F), glm::vec3(0.3F, 0.2F, 0.1F)}) {
    for (const bool shadow : {false, true}) {
      auto make = [&] {
        Scene scene = aligned_fog();
        scene.meshes.push_back(make_sphere(0.2F, 32));
        scene.materials.push_back({.name = "grey", .albedo = glm::vec3(0.4F)});
        scene.instances.push_back({.name = "ball", .to_world = glm::translate(glm::mat4(1.0F), {0.3F, 0.2F, 0.1F})});
        scene.lights.push_back(lamp(place, 1.0F, LightKind::point, shadow));
        scene.views.push_back(view_at("at lamp", place, {0.0F, 0.1F, -3.0F}));
        return scene;
      };
      expect_finite(make, c, "front");
      expect_finite(make, c, "at lamp");
    }
  }
}

}  // namespace
}  // namespace pellucid
