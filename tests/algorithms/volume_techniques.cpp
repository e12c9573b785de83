// Sampling hulls and slices against scenes with known answers and against the reference.
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "tests/algorithms/rendered.hpp"
#include "tests/algorithms/scenes.hpp"

namespace pellucid {
namespace {

using namespace test;

std::string number(int n) {
  return std::to_string(n);
}

class AnyMN : public testing::TestWithParam<std::tuple<int, int, const char*>> {};

// Beer–Lambert: with uniform density, extinction and source, any M and N give the same answer, because the valid paths
// of the hulls add up to the path through the box. Thresholds: single-precision frame and coordinates, so only float
// rounding and the silhouette of the box remain (a pixel whose centre the rasteriser and the ray see on different
// sides).
TEST_P(AnyMN, HomogeneousFogAgreesWithBeerLambert) {
  const auto [hulls, samples, view] = GetParam();
  const Rendered r = render(test::fog_box_with_ball({4, 4, 4}, 0.75F, 0.9F), {.values = {{"hulls", number(hulls)},
                                                                                         {"samples", number(samples)},
                                                                                         {"coordinates", "single"},
                                                                                         {"frame.format", "single"}},
                                                                              .view = view});
  const Difference d = difference(r.image, r.reference.image);
  EXPECT_LT(d.max, 1e-3);
  EXPECT_LT(d.mean, 2e-5);
}
INSTANTIATE_TEST_SUITE_P(All, AnyMN,
                         testing::Combine(testing::Values(1, 3, 8, 64), testing::Values(1, 7, 256),
                                          testing::Values("front", "inside", "straddling")));

// The paper's own formats: 8 bits of the local-coordinates map displace a path's end by up to half of 1/255 of the box,
// here 8 mm of fog of 0.7 per metre, or 0.5 % opacity, at each of M hulls; and 16 bits of the frame round at each
// blend.
TEST(SamplingHulls, PaperFormatsStayNearBeerLambert) {
  for (const auto& [hulls, max, mean] :
       {std::tuple{1, 6e-3, 5e-4}, std::tuple{4, 9e-3, 6e-4}, std::tuple{32, 2e-2, 1.2e-3}}) {
    const Rendered r = render(test::fog_box_with_ball({4, 4, 4}, 0.75F, 0.9F), {.values = {{"hulls", number(hulls)}}});
    const Difference d = difference(r.image, r.reference.image);
    EXPECT_LT(d.max, max) << hulls;
    EXPECT_LT(d.mean, mean) << hulls;
  }
}

TEST(SamplingHulls, VolumeBehindTheCameraLeavesTheBackground) {
  const Rendered r =
      render(test::fog_box({4, 4, 4}, 1.0F, 1.0F), {.values = {{"frame.format", "single"}}, .view = "behind"});
  EXPECT_LT(difference(r.image, r.reference.image).max, 1e-6);
  EXPECT_NEAR(r.image.at(3, 3)[0], 0.9F, 1e-6F);
}

TEST(SamplingHulls, EmptyAndOpaqueFog) {
  const Rendered clear =
      render(test::fog_box_with_ball({2, 2, 2}, 0.0F, 1.0F), {.values = {{"frame.format", "single"}}});
  EXPECT_LT(difference(clear.image, clear.reference.image).max, 1e-6);
  const Rendered opaque = render(test::fog_box({2, 2, 2}, 1.0F, 1e4F), {.values = {{"frame.format", "single"}}});
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(opaque.image.at(60, 45)[c], opaque.reference.image.at(60, 45)[c], 1e-5F);
  }
  EXPECT_NEAR(opaque.image.at(60, 45)[3], 0.0F, 1e-6F) << "alpha is the transmittance";
}

Scene bumpy_fog() {
  Scene scene = test::fog_box_with_ball({24, 24, 24}, 1.0F, 2.0F);
  scene.volume->density = make_fog_density({24, 24, 24}, {.seed = 3, .octaves = 2});
  return scene;
}

// Error falls with M·N down to the reference's own step error and the rounding of the density to 16 bits.
TEST(SamplingHulls, ErrorFallsWithSamples) {
  double last = 1;
  for (int samples : {1, 4, 16, 64, 256}) {
    const Rendered r = render(bumpy_fog(), {.values = {{"hulls", "4"},
                                                       {"samples", number(samples)},
                                                       {"sample_offset", "0.5"},
                                                       {"coordinates", "single"},
                                                       {"frame.format", "single"}}});
    const double mean = difference(r.image, r.reference.image).mean;
    EXPECT_LT(mean, std::max(0.6 * last, 2e-4)) << samples;
    last = mean;
  }
  EXPECT_LT(last, 2e-4);
}

// At equal M·N only where the frame is blended differs: with float formats all splits agree with one another.
TEST(SamplingHulls, SplitOfTheSamplesMattersLittle) {
  const Settings base{.values = {{"coordinates", "single"}, {"frame.format", "single"}, {"sample_offset", "0.5"}}};
  auto with = [&](int hulls, int samples) {
    Settings s = base;
    s.values.emplace_back("hulls", number(hulls));
    s.values.emplace_back("samples", number(samples));
    return render(bumpy_fog(), s);
  };
  const Rendered one = with(1, 64), many = with(16, 4);
  EXPECT_LT(difference(one.image, one.reference.image).mean, 2e-3);
  EXPECT_LT(difference(many.image, many.reference.image).mean, 2e-3);
}

// The stripes of Fig. 1c: where an opaque object cuts slices, the fog before it jumps by a slab's opacity from slice to
// slice; hulls follow the surface. In homogeneous fog the reference is smooth there, so the jumps are the technique's
// own.
TEST(VolumeSlices, ShowStripesWhereHullsDoNot) {
  const Rendered slices = render(test::fog_box_with_ball({4, 4, 4}, 1.0F, 1.0F),
                                 {.technique = "volume_slices", .values = {{"slices", "32"}}});
  const Rendered hulls = render(test::fog_box_with_ball({4, 4, 4}, 1.0F, 1.0F), {});
  const Difference striped = difference(slices.image, slices.reference.image);
  const Difference smooth = difference(hulls.image, hulls.reference.image);
  EXPECT_GT(striped.max, 0.1)
      << "a slab of 4 m / 32 has an opacity of 12 %, missing or too much where the ball cuts it";
  EXPECT_GT(striped.mean, 3e-3);
  EXPECT_LT(smooth.max, 1.2e-2) << "8-bit coordinates: 8 mm of fog of 1 per metre at the path's end";
  EXPECT_LT(smooth.mean, 6e-4);
}

TEST(VolumeSlices, ConvergeToTheReference) {
  double last = 1;
  for (int slices : {8, 64, 512, 4096}) {
    const Rendered r = render(bumpy_fog(), {.technique = "volume_slices",
                                            .values = {{"slices", number(slices)}, {"frame.format", "single"}}});
    const double mean = difference(r.image, r.reference.image).mean;
    EXPECT_LT(mean, std::max(0.5 * last, 2e-4)) << slices;
    last = mean;
  }
  EXPECT_LT(last, 2e-4);
}

TEST(VolumeSlices, ObjectAlignedOnesConvergeFromEverySide) {
  for (const char* view : {"front", "inside", "straddling"}) {
    const Rendered r =
        render(bumpy_fog(), {.technique = "volume_slices",
                             .values = {{"slices", "2048"}, {"alignment", "object"}, {"frame.format", "single"}},
                             .view = view});
    const Difference d = difference(r.image, r.reference.image);
    // A ray that runs nearly along the slices meets few of them, so single pixels stay off by a slab's opacity.
    EXPECT_LT(d.mean, 5e-4) << view;
    EXPECT_LT(d.max, 5e-2) << view;
  }
}

TEST(RayMarching, AgreesWithBeerLambertForAnyNumberOfSamples) {
  for (const char* samples : {"1", "32", "4096"}) {
    for (const char* view : {"front", "inside", "straddling"}) {
      const Rendered r = render(
          test::fog_box_with_ball({4, 4, 4}, 0.75F, 0.9F),
          {.technique = "ray_marching", .values = {{"samples", samples}, {"frame.format", "single"}}, .view = view});
      const Difference d = difference(r.image, r.reference.image);
      EXPECT_LT(d.max, 1e-3) << samples << " " << view;
      EXPECT_LT(d.mean, 2e-5) << samples << " " << view;
    }
  }
}

// Jitter turns the error of few samples into noise of a fixed pattern: it is larger in a pixel and smaller in the mean
// over a tile, so blurring both images over tiles tells them apart.
TEST(RayMarching, InterleavedJitterHasASmallerErrorOverATile) {
  auto tile_error = [](const Rendered& r) {
    double sum = 0;
    for (int y = 0; y + 4 <= r.image.height; y += 4) {
      for (int x = 0; x + 4 <= r.image.width; x += 4) {
        double e = 0;
        for (int k = 0; k < 16; ++k) {
          e += static_cast<double>(r.image.at(x + k % 4, y + k / 4)[1]) -
               static_cast<double>(r.reference.image.at(x + k % 4, y + k / 4)[1]);
        }
        sum += std::abs(e / 16);
      }
    }
    return sum;
  };
  auto with = [](const char* jitter) {
    return render(
        bumpy_fog(),
        {.technique = "ray_marching",
         .values = {{"samples", "4"}, {"sample_offset", "0"}, {"jitter", jitter}, {"frame.format", "single"}}});
  };
  EXPECT_LT(tile_error(with("interleaved")), 0.5 * tile_error(with("none")));
}

// A point light inside the fog makes the source vary along the path: both techniques follow it.
TEST(VolumeTechniques, PointLightInTheFog) {
  for (const char* technique : {"sampling_hulls", "volume_slices", "ray_marching"}) {
    Scene scene = test::fog_box_with_ball({4, 4, 4}, 1.0F, 0.5F);
    scene.lights.push_back(
        {.name = "lamp", .kind = LightKind::point, .position = {0.6F, 0.9F, 0.4F}, .intensity = glm::vec3(2.0F)});
    const bool hulls = std::string(technique) == "sampling_hulls";
    Settings settings{.technique = technique, .values = {{"frame.format", "single"}}};
    if (hulls) {
      settings.values.insert(settings.values.end(),
                             {{"samples", "128"}, {"sample_offset", "0.5"}, {"coordinates", "single"}});
    } else {
      settings.values.emplace_back(std::string(technique) == "volume_slices" ? "slices" : "samples", "1024");
    }
    const Rendered r = render(std::move(scene), settings);
    const Difference d = difference(r.image, r.reference.image);
    // The source has a pole at the lamp: a step near it sees its value at one point only.
    EXPECT_LT(d.mean, 2e-3) << technique;
    EXPECT_LT(d.max, 0.1) << technique;
  }
}

TEST(RenderSession, RefusesWhatTheTechniqueLacks) {
  use_context();
  Scene scene = test::fog_box({2, 2, 2}, 1.0F, 1.0F);
  scene.volume.reset();
  RenderSession session(std::move(scene), "sampling_hulls", "", 8, 8);
  EXPECT_THROW(session.prepare(), InputError);
  EXPECT_THROW(session.resize(100000, 100000), InputError);
  EXPECT_THROW(session.assign_text("hull", "3"), InputError);
  EXPECT_THROW(session.assign_text("frame.fromat", "half"), InputError);
}

// An object that moves between frames is drawn where it is now.
TEST(RenderSession, ChangesOfParametersAreDrawn) {
  use_context();
  RenderSession session(test::fog_box_with_ball({4, 4, 4}, 0.75F, 0.9F), "sampling_hulls", "front", 64, 48);
  gl::PassTimer timer;
  session.render(timer);
  const Image four = session.read_color();
  session.assign_text("hulls", "1");
  session.assign_text("coordinates", "single");
  session.render(timer);
  const Image one = session.read_color();
  EXPECT_GT(difference(four, one).max, 0.0);
  session.assign_text("hulls", "4");
  session.assign_text("coordinates", "automatic");
  session.render(timer);
  EXPECT_EQ(difference(four, session.read_color()).max, 0.0) << "the same parameters give the same picture";
}

}  // namespace
}  // namespace pellucid
