// The laws of optics: GLSL against C++, and C++ against what is known of them.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/shaders/optics.hpp"
#include "gl/context.hpp"
#include "gl/program.hpp"
#include "tests/algorithms/compute.hpp"

namespace pellucid {
namespace {

struct OpticsInput {
  glm::vec3 n;
  float cosine;
  glm::vec3 k;
  float eta;
  glm::vec3 absorption;
  float path;
};
struct OpticsOutput {
  glm::vec3 metal;
  float dielectric;
  glm::vec3 transmitted;
  float pad;
};

// Every tenth at the ends of the cosine, every seventh an interface between equal media.
std::vector<OpticsInput> optics_inputs() {
  std::mt19937 random(17);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  const auto any = [&](float low, float high) { return low * std::pow(high / low, unit(random)); };
  std::vector<OpticsInput> all;
  for (int i = 0; i < 8192; ++i) {
    OpticsInput q{};
    q.cosine = i % 10 == 0 ? 1.0F : i % 10 == 1 ? 0.0F : unit(random);
    q.eta = i % 7 == 0 ? 1.0F : any(0.2F, 5.0F);
    q.n = {any(0.01F, 20.0F), any(0.01F, 20.0F), any(0.01F, 20.0F)};
    q.k = {50.0F * unit(random), any(0.01F, 50.0F), 0.0F};
    q.absorption = {0.0F, any(0.01F, 10.0F), 100.0F * unit(random)};
    q.path = i % 11 == 0 ? 0.0F : any(1e-3F, 100.0F);
    all.push_back(q);
  }
  return all;
}

TEST(OpticsTwins, AgreeOnRandomInterfaces) {
  const gl::Context context;
  const std::vector<OpticsInput> in = optics_inputs();
  const gl::Program program("optics twins", {"tests/algorithms/optics.comp.glsl"});
  const std::vector<OpticsOutput> out = test::compute<OpticsOutput>(program, in);
  int total = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const OpticsInput& q = in[i];
    const double cosine = static_cast<double>(q.cosine), eta = static_cast<double>(q.eta);
    // Near the critical angle the share rises with a square root: an error of one rounding in sin² counts as its root.
    const double behind2 = 1.0 - eta * eta * (1.0 - cosine * cosine);
    const double tolerance = 4e-6 + 8e-6 * std::max(1.0, eta * eta) / std::sqrt(std::max(std::abs(behind2), 1e-6));
    const double share = fresnel_dielectric(cosine, eta);
    total += share == 1.0 ? 1 : 0;
    EXPECT_NEAR(static_cast<double>(out[i].dielectric), share, tolerance) << cosine << " " << eta;
    const glm::dvec3 metal = fresnel_metal(cosine, glm::dvec3(q.n), glm::dvec3(q.k));
    const glm::dvec3 left = transmitted(glm::dvec3(q.absorption), static_cast<double>(q.path));
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(static_cast<double>(out[i].metal[c]), metal[c], 4e-6) << i;
      // exp(−x): the exponent's rounding counts x-fold.
      const double depth = static_cast<double>(q.absorption[c]) * static_cast<double>(q.path);
      EXPECT_NEAR(static_cast<double>(out[i].transmitted[c]), left[c], 2e-6 + 4e-7 * depth * left[c]) << i;
    }
  }
  EXPECT_GT(total, 1500) << "total reflection must be among the inputs";
}

TEST(Optics, FresnelAtKnownAngles) {
  EXPECT_NEAR(fresnel_dielectric(1.0, 1 / 1.5), 0.04, 1e-15);
  EXPECT_NEAR(fresnel_dielectric(1.0, 1.5), 0.04, 1e-15);
  EXPECT_NEAR(fresnel_dielectric(0.0, 1 / 1.5), 1.0, 1e-15);
  EXPECT_EQ(fresnel_dielectric(std::cos(0.75), 1.5), 1.0) << "beyond 41.8°";
  EXPECT_NEAR(fresnel_dielectric(0.3, 1.0), 0.0, 1e-30);
  // At Brewster's angle nothing of p is reflected: half of s.
  const double brewster = std::atan(1.5), behind = std::numbers::pi / 2 - brewster;
  const double s = std::sin(brewster - behind) / std::sin(brewster + behind);
  EXPECT_NEAR(fresnel_dielectric(std::cos(brewster), 1 / 1.5), 0.5 * s * s, 1e-14);
  // Head-on, with k: ((n−1)² + k²) / ((n+1)² + k²); grazing, everything.
  EXPECT_NEAR(fresnel_metal(1.0, glm::dvec3(0.5), glm::dvec3(5.0)).x, (0.25 + 25.0) / (2.25 + 25.0), 1e-15);
  EXPECT_NEAR(fresnel_metal(0.0, glm::dvec3(0.5), glm::dvec3(5.0)).y, 1.0, 1e-15);
}

TEST(Optics, RefractionIsReversibleAndKeepsTheTangent) {
  std::mt19937 random(23);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> index(0.3, 3.0);
  int total = 0;
  for (int i = 0; i < 4000; ++i) {
    const glm::dvec3 n = glm::normalize(glm::dvec3{normal(random), normal(random), normal(random)});
    glm::dvec3 along = glm::normalize(glm::dvec3{normal(random), normal(random), normal(random)});
    if (glm::dot(along, n) > 0.0) along = -along;
    const double eta = index(random);
    const auto behind = refracted(along, n, eta);
    const double cosine = -glm::dot(along, n);
    ASSERT_EQ(!behind, fresnel_dielectric(cosine, eta) == 1.0);
    if (!behind) {
      ++total;
      continue;
    }
    const glm::dvec3 tangent = along + cosine * n, after = *behind - glm::dot(*behind, n) * n;
    EXPECT_LT(glm::distance(after, eta * tangent), 1e-7) << "Snell";
    const auto back = refracted(-*behind, -n, 1.0 / eta);
    ASSERT_TRUE(back);
    EXPECT_LT(glm::distance(*back, -along), 1e-6);
    EXPECT_NEAR(fresnel_dielectric(std::abs(glm::dot(*behind, n)), 1.0 / eta), fresnel_dielectric(cosine, eta), 1e-6)
        << "Stokes: the same from both sides";
    const glm::dvec3 mirrored = reflected(along, n);
    EXPECT_NEAR(glm::dot(mirrored, n), cosine, 1e-12);
  }
  EXPECT_GT(total, 200);
}

}  // namespace
}  // namespace pellucid
