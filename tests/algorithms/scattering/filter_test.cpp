// Environments filtered on the sphere, the widths of key maps, and their cache.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "algorithms/key_maps/key_chain.hpp"
#include "algorithms/scattering/transfer_fit.hpp"
#include "gl/error.hpp"
#include "tests/temporary_folder.hpp"

namespace pellucid::scattering {
namespace {

using std::numbers::pi;

Environment constant(float value) {
  Environment e;
  e.image = Image(64, 32, 3);
  std::fill(e.image->pixels.begin(), e.image->pixels.end(), value);
  return e;
}

// Dark but for a small lamp and a soft gradient.
Environment lamp(int height) {
  Environment e;
  e.image = Image(2 * height, height, 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < 2 * height; ++x) {
      float* p = e.image->at(x, y);
      p[0] = 0.2F + 0.1F * static_cast<float>(y) / static_cast<float>(height);
      p[1] = 0.3F;
      p[2] = std::abs(x - height / 2) < height / 32 && std::abs(y - height / 3) < height / 32 ? 50.0F : 0.1F;
    }
  }
  return e;
}

TEST(KeyWidths, FollowThePapersTableButForAConstant) {
  // Table 1: the least widths for a threshold of 0.02.
  const double paper[] = {4.6, 10.5, 21.6, 43.4, 86.9, 173.7};
  double mean = 0;
  for (int i = 0; i < 6; ++i)
    mean += least_width(2 << i, 0.02) / paper[i] / 6;
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(least_width(2 << i, 0.02) / paper[i], mean, 0.03 * mean) << (2 << i);
  EXPECT_NEAR(mean, 0.92, 0.02);
}

TEST(KeyWidths, AWidthLiesWhereItsVarianceDoes) {
  const KeyWidths widths(512, 0.02);
  ASSERT_EQ(widths.levels(), 9);
  EXPECT_EQ(widths.level(0), 0);
  EXPECT_EQ(widths.level(100), 9);
  for (int l = 1; l <= 9; ++l)
    EXPECT_NEAR(widths.level(widths.width(l)), l, 1e-12);
  const double a = widths.width(3), b = widths.width(4);
  EXPECT_NEAR(widths.level(std::sqrt(0.75 * a * a + 0.25 * b * b)), 3.25, 1e-12);
}

TEST(EnvironmentFilter, LeavesAConstantAlone) {
  const FilterSource source(constant(0.7F));
  for (const SphereFilter filter : {SphereFilter::direct, SphereFilter::three_maps}) {
    for (const double width : {0.01, 0.1, 0.7, 2.0}) {
      for (const float v : source.filtered(filter, 16, width).rgb)
        ASSERT_NEAR(v, 0.7F, 1e-3F) << width;
    }
  }
}

TEST(EnvironmentFilter, KeepsTheEnergy) {
  const FilterSource source(lamp(128));
  for (const double width : {0.02, 0.1, 0.4, 1.0}) {
    // A map must resolve the width for the sum over its texels to be the integral.
    const KeyMap map = source.filtered(SphereFilter::direct, width < 0.05 ? 128 : 32, width);
    const glm::dvec3 mean = mean_over_sphere(map);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(mean[c] / source.mean()[c], 1, 0.005) << width << ' ' << c;
  }
}

TEST(EnvironmentFilter, SpreadsALampAsAGaussianDoes) {
  // The share of a lamp of a few degrees within an angle, against the integral of the Gaussian.
  const double width = 0.3;
  Environment e = lamp(128);
  for (float& v : e.image->pixels)
    v = v > 1 ? v : 0;  // nothing but the lamp, in blue
  const KeyMap map = FilterSource(e).filtered(SphereFilter::direct, 64, width);
  const glm::dvec3 to_lamp = SphereMap(256, 128).direction(64, 42);
  double within = 0, all = 0;
  std::size_t at = 2;
  for (int face = 0; face < 6; ++face) {
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x, at += 3) {
        const glm::dvec3 d = texel_direction(64, face, x, y);
        const double energy = texel_area(64, x, y) * static_cast<double>(map.rgb[at]);
        all += energy;
        if (glm::dot(d, to_lamp) > std::cos(0.4)) within += energy;
      }
    }
  }
  // The lamp is 5° wide, and the map's texels 1.4°.
  EXPECT_NEAR(within / all, gaussian_within(width, 0.4), 0.01);
}

TEST(EnvironmentFilter, ThePapersWayIsNearWhereTheWidthIsSmall) {
  const FilterSource source(lamp(128));
  const auto apart = [&](double width) {
    return relative_rms(source.filtered(SphereFilter::three_maps, 32, width),
                        source.filtered(SphereFilter::direct, 32, width));
  };
  // On flat maps a width far from the equator is stretched, by up to 1.22 where no map has its equator near: a small
  // lamp shows that more than a photograph does. Wide filters err most.
  EXPECT_LT(apart(0.1), 0.12);
  EXPECT_GT(apart(0.8), 0.005);
}

TEST(EnvironmentFilter, AtPolesAndSeamsItIsAsSmoothAsElsewhere) {
  // The map of a lamp at a pole is that of a lamp elsewhere, turned.
  Environment pole = constant(0), side = constant(0);
  const auto light = [](Environment& e, const glm::dvec3& towards) {
    const SphereMap grid(64, 32);
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 64; ++x)
        e.image->at(x, y)[0] = static_cast<float>(std::exp(20 * (glm::dot(grid.direction(x, y), towards) - 1)));
    }
  };
  light(pole, {0, 1, 0});
  light(side, {1, 0, 0});
  const KeyMap a = FilterSource(pole).filtered(SphereFilter::direct, 16, 0.25),
               b = FilterSource(side).filtered(SphereFilter::direct, 16, 0.25);
  // By the angle to the lamp, on the two faces around it: +y of the first and +x of the second look alike but for a
  // turn.
  const std::size_t face = 16 * 16 * 3;
  for (const std::size_t i : {std::size_t{0}, std::size_t{7 * 16 + 7} * 3, std::size_t{15 * 16 + 15} * 3})
    EXPECT_NEAR(a.rgb[2 * face + i], b.rgb[i], 0.01) << i;
}

TEST(EnvironmentFilter, RefusesWhatIsNoEnvironment) {
  Environment flat;
  flat.image = Image(64, 64, 3);
  EXPECT_THROW(FilterSource{flat}, InputError);
  for (const float bad : {-1.0F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Environment e = constant(1);
    e.image->at(5, 3)[1] = bad;
    try {
      const FilterSource source(e);
      FAIL() << bad;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("(5, 3)"), std::string::npos) << error.what();
    }
  }
}

TEST(KeyChain, IsTheSameFromItsFile) {
  const test::TemporaryFolder folder;
  const Environment e = lamp(64);
  const KeyChainOptions options{.face_size = 64};
  const KeyChain made = key_chain(e, options, folder.path()), read = key_chain(e, options, folder.path());
  EXPECT_EQ(read.widths.widths(), made.widths.widths());
  EXPECT_EQ(made.half_rgb, read.half_rgb);
  EXPECT_EQ(made.mean, read.mean);
  EXPECT_EQ(made.filter_s, read.filter_s);  // that of the first, so that the second did not filter
  EXPECT_EQ(made.half_rgb.size(), 6U);
  EXPECT_LT(made.bytes(), made.full_resolution_bytes() / 4);
  KeyChainOptions other = options;
  other.omega = 0.05;
  EXPECT_NE(key_chain(e, other, folder.path()).half_rgb, made.half_rgb);
  for (const auto& file : std::filesystem::directory_iterator(folder.path()))
    std::filesystem::resize_file(file.path(), 300);
  EXPECT_EQ(key_chain(e, options, folder.path()).half_rgb, made.half_rgb);  // with a warning
}

TEST(KeyChain, BrighterThanHalfPrecisionIsScaled) {
  Environment e = constant(3e5F);
  const KeyChain chain = key_chain(e, {.face_size = 64}, "");
  EXPECT_GT(chain.scale, 4);
  EXPECT_NEAR(chain.mean.x, 3e5, 300);
}

TEST(KeyChain, RefusesSizesAndThresholds) {
  for (const int size : {32, 100, 2048})
    EXPECT_THROW(key_chain(constant(1), {.face_size = size}, ""), InputError) << size;
  for (const double omega : {0.0, -1.0, 0.6, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(key_chain(constant(1), {.face_size = 64, .omega = omega}, ""), InputError) << omega;
}

}  // namespace
}  // namespace pellucid::scattering
