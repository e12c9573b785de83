// The media techniques at their least settings and with extreme volumes.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tests/algorithms/hard_cases.hpp"

namespace pellucid {
namespace {

using namespace test;

class HardVolumes : public HardCases {};
INSTANTIATE_TEST_SUITE_P(All, HardVolumes, testing::ValuesIn(contenders()),
                         [](const auto& instance) { return std::string(instance.param.name); });

double largest(const glm::dvec3& v) {
  return std::max({v.x, v.y, v.z});
}

// ---- least settings ----

// One hull with one point, or one march of one step, is exact in uniform fog under uniform light. One slice in the
// middle is exact wherever the ray goes through both of the box's faces and the slice; beside it there is nothing.
TEST_P(HardVolumes, OnePointOnEachPath) {
  Scene scene = aligned_fog(0.5F);
  scene.ambient = glm::vec3(1.0F);
  const Camera camera{scene.views[0], 60, 45};
  Values values = c.least;
  if (!c.slices)
    values.emplace_back(c.technique == "sampling_hulls" ? "coordinates" : "sample_offset",
                        c.technique == "sampling_hulls" ? "single" : "0.5");
  const Image image = frame(std::move(scene), settings(c, values));
  double worst = 0;
  int inside = 0;
  for (int y = 0; y < 45; ++y) {
    for (int x = 0; x < 60; ++x) {
      const glm::dvec3 d = camera.ray_direction(x + 0.5, y + 0.5), eye(camera.view.eye);
      const glm::dvec3 a = (-1.0 - eye) / d, b = (1.0 - eye) / d;
      const double begin = largest(glm::min(a, b)), end = -largest(-glm::max(a, b));
      double path = std::max(end - begin, 0.0);
      if (c.slices) {
        const glm::dvec3 on_slice = eye + d * (4.0 / -d.z);
        path = largest(glm::abs(on_slice)) < 1 ? 2.0 / -d.z : 0.0;
      }
      inside += path > 0 ? 1 : 0;
      worst = std::max(worst, std::abs(static_cast<double>(image.at(x, y)[0]) - 0.9 * -std::expm1(-0.5 * path)));
    }
  }
  EXPECT_GT(inside, 1000);
  EXPECT_LT(worst, 2e-5) << "rounding of single-precision coordinates";
}

// With several lights and shadows there is no such answer: nothing breaks, and no point is brighter than the brightest
// source.
TEST_P(HardVolumes, OnePointUnderLightsAndShadows) {
  auto make = [] {
    Scene scene = fog_box_with_ball({4, 4, 4}, 1.0F, 0.5F);
    scene.lights = {lamp({0.0F, 3.0F, 0.0F}, 9.0F, LightKind::point, true),
                    lamp({-2.0F, 2.0F, 1.0F}, 9.0F, LightKind::spot, true),
                    lamp(glm::vec3(0.0F), 1.0F, LightKind::directional, true)};
    scene.lights[1].direction = glm::normalize(glm::vec3(2.0F, -2.0F, -1.0F));
    return scene;
  };
  for (const char* view : {"front", "inside", "straddling"})
    expect_finite(make, c, view);
}

// ---- extreme volumes ----

// A density that varies along some axes only. Slabs and steps of a few millimetres see its slope to second order, and
// the 16-bit density map is off by 2^-11 of the opacity at most.
TEST_P(HardVolumes, OneVoxelAxes) {
  for (const glm::ivec3& voxels : {glm::ivec3(1, 24, 24), glm::ivec3(24, 1, 24), glm::ivec3(24, 24, 1),
                                   glm::ivec3(24, 1, 1), glm::ivec3(1, 24, 1), glm::ivec3(1, 1, 24), glm::ivec3(1)}) {
    SCOPED_TRACE(testing::Message() << voxels.x << " x " << voxels.y << " x " << voxels.z);
    auto make = [&] {
      Scene scene = fog_box_with_ball(voxels, 1.0F, 2.0F);
      scene.volume->density = make_fog_density(voxels, {.seed = 3, .octaves = 2});
      return scene;
    };
    expect_near(make, c.slices ? 7e-3 : 1e-3, c.slices ? 2e-4 : 6e-5);
    expect_finite(make, c, "inside");
  }
}

// Without density there is nothing but the surfaces, under any light.
TEST_P(HardVolumes, ZeroDensity) {
  for (const bool by_density : {false, true}) {
    auto make = [&] {
      Scene scene = fog_box_with_ball({2, 2, 2}, by_density ? 0.0F : 1.0F, by_density ? 1e6F : 0.0F);
      scene.lights.push_back(lamp({0.6F, 0.9F, 0.4F}, 2.0F, LightKind::point, true));
      return scene;
    };
    for (const Values& values : {c.least, c.fine}) {
      RenderSession session = start(make(), settings(c, values));
      gl::PassTimer timer;
      session.render(timer);
      const Image image = session.read_color();
      // The same forward pass with the same shadow maps and the volume out of sight.
      Scene bare = make();
      bare.volume->to_world[3].z += 500.0F;
      const Image expected = frame(std::move(bare), settings(c, values));
      EXPECT_EQ(difference(image, expected).max, 0.0);
      EXPECT_EQ(image.at(30, 22)[3], 1.0F) << "transmittance";
    }
    expect_finite(make, c, "inside");
  }
}

// So dense that a millimetre is opaque, or that φ is 10¹², where a 16-bit voxel or a sum of extinctions could overflow:
// the box's surface is seen, with the source radiance at it.
TEST_P(HardVolumes, FullDensity) {
  for (const auto& [density, extinction] : {std::pair{1.0F, 1e4F}, std::pair{1.0F, 1e6F}, std::pair{1e6F, 1e6F}}) {
    SCOPED_TRACE(testing::Message() << density << " x " << extinction);
    for (const Values& values : {c.least, c.fine}) {
      Scene scene = aligned_fog(extinction, {4, 4, 4}, density);
      scene.environment.zenith = scene.environment.horizon = scene.environment.ground = glm::vec3(7.0F);
      scene.ambient = glm::vec3(0.5F);
      const Image image = frame(std::move(scene), settings(c, values));
      EXPECT_EQ(not_finite(image), 0);
      EXPECT_NEAR(image.at(30, 22)[0], 0.45F, 1e-6F);
      EXPECT_NEAR(image.at(30, 22)[2], 0.15F, 1e-6F);
      EXPECT_EQ(image.at(30, 22)[3], 0.0F) << "transmittance";
    }
    auto lit = [&, &density = density, &extinction = extinction] {
      Scene s = aligned_fog(extinction, {4, 4, 4}, density);
      s.lights.push_back(lamp({0.5F, 0.7F, 2.0F}, 10.0F));
      return s;
    };
    // At (0, 0, 1), r² = 1.74; the last point lies up to 2 m / 1024 behind the face, where r² is 0.2 % more.
    const double expected = 0.9 * 10.0 / 1.74 / (4 * std::numbers::pi);
    Settings s = settings(c, c.fine);
    s.width = 45;  // odd numbers: the middle pixel's ray is the z axis
    EXPECT_NEAR(frame(lit(), s).at(22, 22)[0], expected, 3e-3 * expected);
    expect_finite(lit, c, "front");
  }
}

// Densities that 16-bit floats cannot hold, or only with few bits, are the same medium with the extinction the other
// way: a power of two changes no bit of a float but its exponent.
TEST_P(HardVolumes, AnyUnitOfDensity) {
  for (const bool transfer : {false, true}) {
    auto make = [&](float unit) {
      Scene scene = fog_box_with_ball({24, 24, 24}, 1.0F, 2.0F);
      Volume& volume = *scene.volume;
      volume.density = make_fog_density(volume.size, {.seed = 3, .octaves = 2});
      for (float& d : volume.density)
        d *= unit;
      if (transfer) {
        volume.transfer = {{0.1F * unit, 0.0F, glm::vec3(0.2F)}, {0.4F * unit, 2.0F, {1.0F, 0.5F, 0.0F}}};
      } else {
        volume.extinction /= unit;
      }
      return scene;
    };
    const Image image = frame(make(1.0F), settings(c, {}));
    for (const float unit : {0x1p20F, 0x1p-40F})
      EXPECT_LT(difference(frame(make(unit), settings(c, {})), image).max, 1e-6)
          << unit << (transfer ? ", transfer" : "");
    // Kinks of the transfer function between two points of a path cost the square of a step; 16-bit densities and the
    // 1,024 entries of its table up to 1e-3 of an opacity.
    expect_near([&] { return make(0x1p20F); }, c.slices ? 1e-2 : 2e-3, 3e-4);
  }
}

// The far plane cuts objects, not the medium.
TEST_P(HardVolumes, VolumeAcrossTheFarPlane) {
  auto make = [] {
    Scene scene = fog_box({4, 4, 4}, 1.0F, 0.5F);
    scene.views[0].far_m = 6.0F;  // its middle
    return scene;
  };
  expect_near(make, c.slices ? 5e-3 : 2e-4, c.slices ? 4e-4 : 2e-5);
}

// Imagire et al. 2007, Fig. 11: the voxels store the light. Seen from outside, from among them, and from the lamp.
TEST_P(HardVolumes, VolumeInALightsSpace) {
  auto make = [](bool shadow) {
    Scene scene;
    scene.name = "cone";
    scene.lights.push_back(lamp({0.0F, 2.0F, 0.0F}, 3.0F, LightKind::spot, shadow));
    scene.lights.push_back(lamp({3.0F, 2.0F, 0.0F}, 30.0F));  // not scattered in it
    Volume volume;
    volume.name = "cone";
    volume.size = {24, 24, 32};
    volume.density = make_constant_density(volume.size, 1.0F);
    volume.extinction = 0.5F;
    volume.light = 0;
    volume.scattering = make_cone_scattering(volume.size, {.near_m = 0.1, .range_m = 3.0});
    const float half = 3.0F * std::tan(glm::radians(30.0F));
    volume.to_world = glm::mat4(glm::vec4(2 * half, 0, 0, 0), glm::vec4(0, 0, 2 * half, 0), glm::vec4(0, -2.9F, 0, 0),
                                glm::vec4(-half, 1.9F, -half, 1));
    scene.volume = volume;
    scene.meshes.push_back(make_sphere(0.3F, 64));
    scene.materials.push_back({.name = "grey", .albedo = glm::vec3(0.4F)});
    scene.instances.push_back({.name = "ball", .to_world = glm::translate(glm::mat4(1.0F), {0.2F, 0.6F, 0.1F})});
    scene.views = {view_at("front", {0.5F, 1.0F, 6.0F}, {0.0F, 0.7F, 0.0F}, 40.0F),
                   view_at("inside", {0.5F, 0.3F, 0.6F}, {-0.3F, 0.9F, -0.5F}),
                   view_at("lamp", {0.0F, 2.0F, 0.0F}, {0.01F, 0.0F, 0.02F})};
    return scene;
  };
  for (const char* view : {"front", "inside", "lamp"}) {
    for (const bool shadow : {false, true}) {
      // Near the lamp the stored light grows from voxel to voxel, and points half a step off see it: 1e-3 of the
      // brightest pixel. With shadows the shadow map's blur on top of that.
      expect_near([&] { return make(shadow); },
                  shadow     ? 3e-2
                  : c.slices ? 1e-2
                             : 1e-3,
                  shadow ? 2e-3 : 4e-4, view, {{"shadow.size", "1024"}, {"shadow.bleeding", "0.1"}});
    }
    expect_finite([&] { return make(true); }, c, view);
  }
}

// Named with its size and the limit, before anything is allocated.
TEST_P(HardVolumes, BeyondTheDevicesLimit) {
  use_context();
  const int limit = gl::limits().max_3d_texture_size;
  for (int axis = 0; axis < 3; ++axis) {
    Scene scene = aligned_fog();
    scene.volume->size[axis] = limit + 1;
    scene.volume->density.assign(static_cast<std::size_t>(limit) + 1, 1.0F);
    RenderSession session = start(std::move(scene), settings(c, {}));
    const std::size_t before = gl::allocated_bytes();
    try {
      session.prepare();
      ADD_FAILURE() << "no error";
    } catch (const InputError& error) {
      const std::string message = error.what();
      for (const std::string& part : {c.technique, std::string("'fog'"), std::to_string(limit + 1),
                                      "allows " + std::to_string(limit) + " along an axis"})
        EXPECT_NE(message.find(part), std::string::npos) << message;
    }
    EXPECT_EQ(gl::allocated_bytes(), before);
  }
}

}  // namespace
}  // namespace pellucid
