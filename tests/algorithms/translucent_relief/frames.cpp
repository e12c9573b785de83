// Frames of the technique against closed forms and against the reference.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/shaders/optics.hpp"
#include "tests/algorithms/relief_scenes.hpp"
#include "tests/algorithms/rendered.hpp"
#include "tests/algorithms/scene/folder_test.hpp"

namespace pellucid {
namespace {

using namespace test;

Settings settings(Values values = {}) {
  values.emplace_back("frame.format", "single");
  return {.technique = "translucent_relief", .values = std::move(values), .view = "front", .width = 96, .height = 72};
}

Image truth(const Scene& scene, int width, int height) {
  return trace_surfaces(scene, Camera{scene.views[0], width, height}).radiance;
}

Relief two_fields() {
  Relief relief;
  relief.solid = layer_of(random_field(64, 3), -0.2F, -0.05F);
  relief.solid.albedo = {0.8F, 0.5F, 0.3F};
  relief.solid.specular = 0.3F;
  relief.translucent = layer_of(random_field(64, 8, 2), -0.2F, 0.0F);
  relief.translucent->specular = 1.0F;
  relief.absorption = {1.0F, 2.0F, 5.0F};
  relief.intensification = 0.3F;
  return relief;
}

// Snell, Fresnel, absorption: the same closed form as in the reference's test, in single precision.
TEST(TranslucentRelief, FlatLayerInClosedForm) {
  Relief relief;
  relief.cut = false;
  relief.solid = flat_layer(-0.25F, -0.5F);
  relief.solid.albedo = {0.8F, 0.5F, 0.3F};
  relief.translucent = flat_layer(-0.05F, -0.5F);
  relief.absorption = {1.0F, 2.0F, 5.0F};
  for (const bool denser : {false, true}) {
    relief.outside_index = denser ? 1.5F : 1.0F;
    relief.index = denser ? 1.1F : 1.33F;
    Scene scene = relief_scene(relief);
    const Camera camera{scene.views[0], 96, 72};
    const Image image = frame(relief_scene(relief), settings());
    const double eta = static_cast<double>(relief.outside_index) / static_cast<double>(relief.index);
    int total = 0;
    double worst = 0;
    for (int y = 0; y < 72; ++y) {
      for (int x = 0; x < 96; ++x) {
        const glm::dvec3 v = camera.ray_direction(x + 0.5, y + 0.5);
        const glm::dvec3 at = glm::dvec3(camera.view.eye) - v * (static_cast<double>(camera.view.eye.y) / v.y);
        if (std::abs(at.x) > 0.99 || std::abs(at.z) > 0.99) continue;  // beside the quad
        const double cosine = -v.y, reflected_share = fresnel_dielectric(cosine, eta);
        total += reflected_share == 1 ? 1 : 0;
        const double inner = std::sqrt(std::max(0.0, 1 - eta * eta * (1 - cosine * cosine)));
        for (int c = 0; c < 3; ++c) {
          const double absorption = static_cast<double>(relief.absorption[c]);
          const double entering = 1 - fresnel_dielectric(0.8, eta);
          const double floor = static_cast<double>(relief.solid.albedo[c]) *
                               (0.2 + entering * std::exp(-absorption * 0.2 / 0.8) *
                                          static_cast<double>(scene.lights[0].intensity[c]) * 0.8 / std::numbers::pi);
          const double seen = reflected_share == 1 ? 0 : std::exp(-absorption * 0.2 / inner) * floor;
          const double expected =
              (1 - reflected_share) * seen + reflected_share * static_cast<double>(scene.environment.zenith[c]);
          worst = std::max(worst, std::abs(static_cast<double>(image.at(x, y)[c]) - expected));
        }
      }
    }
    // Single precision; near the critical angle the share rises with a square root.
    EXPECT_LT(worst, denser ? 2e-3 : 1e-4);
    if (denser) {
      EXPECT_GT(total, 100) << "total reflection is in the picture";
    }
  }
}

// A flat ground of 2 × 2 m, seen along it, under air whose squared index rises from 1 linearly by `rise` over its
// height.
Scene mirage_scene(float height_m, float rise) {
  Relief relief;
  relief.cut = false;
  relief.solid = flat_layer(0.0F, -0.1F);
  ReliefAir air;
  air.height_m = height_m;
  air.size = {2, 2, 32};
  for (int z = 0; z < 32; ++z)
    air.index2.insert(air.index2.end(), 4, 1.0F + rise * static_cast<float>(z) / 31.0F);
  relief.air = air;
  Scene scene = relief_scene(relief);
  scene.views[0] = {.name = "front", .eye = {0.0F, 0.35F, 1.4F}, .target = {0.0F, 0.0F, -0.5F}, .fov_y_deg = 30.0F};
  return scene;
}

// A mirage against rays of fourth order.
TEST(TranslucentRelief, BendsRaysAsTheReferenceDoes) {
  const Image expected = truth(mirage_scene(0.2F, 0.04F), 96, 72), image = frame(mirage_scene(0.2F, 0.04F), settings());
  int sky = 0, differ = 0;
  for (int y = 0; y < 72; ++y) {
    for (int x = 0; x < 96; ++x) {
      differ += std::abs(image.at(x, y)[0] - expected.at(x, y)[0]) > 0.02F ? 1 : 0;
      sky += std::abs(image.at(x, y)[2] - 0.4F) < 1e-5F ? 1 : 0;
    }
  }
  EXPECT_GT(sky, 1000);
  // Where the last ray still turns is a line in the picture.
  EXPECT_LE(differ, 2 * 96);
  const Image straight = frame(mirage_scene(0.2F, 0.04F), settings({{"air_steps", "0"}}));
  EXPECT_GT(difference(straight, image).mean, 0.01) << "the air does something";
}

// Two boxes, red over green, partly in the bent air and partly over it: their image in the ground is upside down.
TEST(TranslucentRelief, AMirageIsUpsideDown) {
  const auto make = [] {
    Scene scene = mirage_scene(0.02F, 0.08F);
    scene.meshes.push_back(make_box({0.5F, 0.12F, 0.1F}));
    scene.materials.push_back({.name = "green", .albedo = {0.05F, 0.9F, 0.05F}});
    scene.materials.push_back({.name = "red", .albedo = {0.9F, 0.05F, 0.05F}});
    for (int i = 0; i < 2; ++i) {
      scene.instances.push_back({.name = i == 0 ? "below" : "above", .mesh = 1, .material = 1 + i});
      scene.instances.back().to_world[3] = {0.0F, 0.06F + 0.12F * static_cast<float>(i), -0.9F, 1.0F};
    }
    return scene;
  };
  // The middle column from above downwards: red, green, or anything else.
  const auto column = [](const Image& image) {
    std::string seen;
    for (int y = 0; y < image.height; ++y) {
      const float* c = image.at(48, y);
      const char what = c[0] > 3 * c[1] ? 'r' : c[1] > 3 * c[0] ? 'g' : '.';
      if (seen.empty() || seen.back() != what) seen += what;
    }
    return seen;
  };
  const Image image = frame(make(), settings());
  EXPECT_EQ(column(image), ".rgr.");
  EXPECT_EQ(column(frame(make(), settings({{"air_steps", "0"}}))), ".rg.");
  const Image expected = truth(make(), 96, 72);
  EXPECT_EQ(column(expected), ".rgr.");
  // Edges fall on the next pixel's side, and the boxes' undersides are not on the screen.
  EXPECT_LT(difference(image, expected).mean, 8e-3);
}

// A ball mostly in the medium, seen through it and mirrored in it.
TEST(TranslucentRelief, ObjectsDipIn) {
  Relief relief;
  relief.solid = flat_layer(-0.4F, -0.5F);
  relief.translucent = flat_layer(-0.01F, -0.5F);
  const auto make = [&] {
    Scene scene = relief_scene(relief);
    scene.meshes.push_back(make_sphere(0.25F, 64));
    scene.materials.push_back({.name = "red", .albedo = {0.9F, 0.1F, 0.1F}});
    scene.instances.push_back({.name = "ball", .mesh = 1, .material = 1});
    scene.instances[1].to_world[3] = {0.0F, -0.15F, 0.0F, 1.0F};
    return scene;
  };
  const Image expected = truth(make(), 96, 72);
  const Values fine{{"object_steps", "256"}};
  const double seen = difference(frame(make(), settings(fine)), expected).mean;
  EXPECT_LT(seen, 2e-3);
  EXPECT_LT(seen, 0.5 * difference(frame(make(), settings({{"object_steps", "0"}})), expected).mean)
      << "without them the ball ends at the surface";
}

// All optics on curved layers: what differs are features between the search's steps, at silhouettes and shadows' edges.
TEST(TranslucentRelief, NearTheReference) {
  const Image expected = truth(relief_scene(two_fields()), 96, 72);
  const Difference coarse = difference(frame(relief_scene(two_fields()), settings()), expected);
  EXPECT_LT(coarse.mean, 4e-3);
  const Values fine{{"view_steps", "512"},           {"reflected_steps", "512"},      {"refracted_steps", "512"},
                    {"light_steps", "512"},          {"view_refinements", "10"},      {"light_refinements", "10"},
                    {"refracted_refinements", "10"}, {"reflected_refinements", "10"}, {"boundaries", "8"}};
  const Difference close = difference(frame(relief_scene(two_fields()), settings(fine)), expected);
  EXPECT_LT(close.mean, 1e-3);
  // Both may be as near as single precision allows, some 2e-6; the picture has something to miss all the same.
  EXPECT_LT(close.mean, std::max(coarse.mean, 5e-6));
  EXPECT_GT(difference(frame(relief_scene(two_fields()), settings({{"translucency", "false"}})), expected).mean, 1e-2);
}

// Boxes of their own find the same surfaces.
TEST(TranslucentRelief, SeparateBoxesSeeTheSame) {
  const Image shared = frame(relief_scene(two_fields()), settings({{"view_steps", "256"}}));
  const Image apart = frame(relief_scene(two_fields()), settings({{"view_steps", "256"}, {"boxes", "separate"}}));
  EXPECT_LT(difference(shared, apart).mean, 1e-3);
}

TEST(TranslucentRelief, CutsTheSilhouetteWhereTheTextureEnds) {
  Relief relief;
  relief.solid = flat_layer(-0.3F, -0.5F);
  Scene scene = relief_scene(relief);
  scene.views[0] = {.name = "front", .eye = {0.0F, 0.4F, 1.6F}, .target = {0.0F, -0.3F, -1.0F}, .fov_y_deg = 60.0F};
  const Camera camera{scene.views[0], 96, 72};
  const Image expected = truth(scene, 96, 72);
  const Image image = frame(std::move(scene), settings());
  int cut = 0, wrong = 0;
  for (int y = 0; y < 72; ++y) {
    for (int x = 0; x < 96; ++x) {
      const glm::dvec3 eye(camera.view.eye), v = camera.ray_direction(x + 0.5, y + 0.5);
      if (v.y >= 0) continue;
      const glm::dvec3 lid = eye - v * (eye.y / v.y), floor = eye - v * ((eye.y + 0.3) / v.y);
      const auto on = [](const glm::dvec3& p) { return std::abs(p.x) < 1 && std::abs(p.z) < 1; };
      if (!on(lid)) continue;
      const bool environment = std::abs(image.at(x, y)[2] - 0.4F) < 1e-6F;
      cut += on(floor) ? 0 : 1;
      wrong += environment == on(floor) ? 1 : 0;
      EXPECT_NEAR(image.at(x, y)[0], expected.at(x, y)[0], 1e-4F) << x << ", " << y;
    }
  }
  EXPECT_GT(cut, 50);
  EXPECT_EQ(wrong, 0);
}

TEST(TranslucentRelief, OddMapsAndLights) {
  Relief relief = two_fields();
  relief.translucent = layer_of(random_field(24, 8, 2), -0.2F, 0.0F);  // of another size
  Scene scene = relief_scene(relief);
  scene.lights.clear();
  EXPECT_EQ(not_finite(frame(std::move(scene), settings())), 0) << "no light";
  Scene buried = relief_scene(relief);
  buried.reliefs[0].translucent = flat_layer(-0.3F, -0.4F);
  Scene bare = relief_scene(relief);
  bare.reliefs[0].translucent.reset();
  EXPECT_LT(difference(frame(std::move(buried), settings()), frame(std::move(bare), settings())).mean, 2e-3)
      << "a medium below the solid is not there";
  Scene unmapped = relief_scene(relief);
  unmapped.meshes[0].uvs.clear();
  EXPECT_EQ(message_of([&] { frame(std::move(unmapped), settings()); }),
            "'ground' of scene 'relief' has no texture coordinates, so that no relief can lie on it (mesh 'plane')");
  Scene creased = relief_scene(relief);
  creased.meshes[0].uvs.assign(creased.meshes[0].uvs.size(), glm::vec2(0.5F));
  EXPECT_EQ(message_of([&] { frame(std::move(creased), settings()); }),
            "'ground' of scene 'relief': the texture coordinates around vertex 0 of mesh 'plane' span no area, so that "
            "it has no tangents");
}

// Maps of one texel: all searches meet a level layer over a level floor.
TEST(TranslucentRelief, MapsOfOneTexelByEverySearch) {
  Relief relief = two_fields();
  relief.solid = flat_layer(-0.2F, -0.3F);
  relief.translucent = flat_layer(-0.05F, -0.3F);
  const Image expected = truth(relief_scene(relief), 96, 72);
  for (const char* search : {"linear", "max_mip", "cone_step", "relaxed_cone_step"}) {
    // The edge of the mesh, where a rounding tells whether a ray leaves it, is a few pixels.
    EXPECT_LT(difference(frame(relief_scene(relief), settings({{"search", search}})), expected).mean, 2e-4) << search;
  }
}

TEST(TranslucentRelief, EveryParameterDrawsAtItsEnds) {
  use_context();
  RenderSession session(relief_scene(two_fields()), "translucent_relief", "front", 24, 18);
  gl::PassTimer timer;
  for (const ParameterInfo& info : session.technique().parameters().infos()) {
    std::vector<Value> values;
    if (info.type == ValueType::integer) {
      values = {static_cast<std::int64_t>(info.min), static_cast<std::int64_t>(info.max)};
    } else if (info.type == ValueType::real) {
      values = {info.min, info.max};
    } else if (info.type == ValueType::boolean) {
      values = {false, true};
    } else {
      values.assign(info.choices.begin(), info.choices.end());
    }
    for (const Value& value : values) {
      session.assign(info.name, value);
      session.render(timer);
      EXPECT_EQ(not_finite(session.read_color()), 0) << info.name << " = " << to_text(value);
    }
    session.assign(info.name, info.default_value);
  }
}

TEST(TranslucentRelief, OthersRefuseReliefs) {
  use_context();
  try {
    const RenderSession session(relief_scene(two_fields()), "front_refraction", "front", 24, 18);
    FAIL() << "drawn";
  } catch (const InputError& error) {
    EXPECT_EQ(
        std::string(error.what()),
        "technique 'front_refraction' draws no reliefs, and 'ground' of scene 'relief' carries one; those that do: "
        "translucent_relief");
  }
}

}  // namespace
}  // namespace pellucid
