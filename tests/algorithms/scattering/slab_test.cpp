// Slabs against van de Hulst's tables, against photons, and against themselves.
#include "algorithms/scattering/slab.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/scattering/transfer_table.hpp"
#include "algorithms/scene/noise.hpp"
#include "gl/error.hpp"

namespace pellucid::scattering {
namespace {

using std::numbers::pi;

TEST(Slab, AgreesWithVanDeHulst) {
  // van de Hulst 1980 (references.bib: vandehulst1980), perpendicular incidence.
  const SlabLight light = Slab({0.75, 0.9}).light(2);
  EXPECT_NEAR(light.reflectance, 0.09739, 1e-5);
  EXPECT_NEAR(light.transmittance, 0.66096, 1e-5);
}

TEST(Slab, LosesNoEnergyWhereNothingIsAbsorbed) {
  for (const double g : {-0.6, 0.0, 0.5, 0.8, 0.95, 0.99}) {
    const Slab slab({g, 1});
    for (const double depth : {0.0, 1e-14, 1e-6, 0.01, 1.0, 30.0, 1e4}) {
      const SlabLight light = slab.light(depth);
      EXPECT_NEAR(light.reflectance + light.transmittance, 1, 1e-6) << g << " " << depth;
    }
  }
}

TEST(Slab, LetsOnlyTheUnscatteredThroughWhereNothingScatters) {
  const SlabLight light = Slab({0.5, 0}).light(3);
  EXPECT_NEAR(light.transmittance, std::exp(-3), 1e-12);
  EXPECT_NEAR(light.reflectance, 0, 1e-12);
}

TEST(Slab, OfIsotropicEndlessDepthReflectsAsChandrasekharSays) {
  // The plane albedo at perpendicular incidence of a half-space is 1 − H(1)√(1 − ω), where H solves the integral
  // equation 1/H(μ) = √(1 − ω) + ω/2 ∫ μ′H(μ′)/(μ + μ′) dμ′ (Chandrasekhar 1960, Ch. V): here by iteration on
  // midpoints.
  constexpr int kPoints = 400;
  const double root = std::sqrt(0.1);
  std::vector<double> h(kPoints, 1.0);
  const auto at = [&](double mu) {
    double sum = 0;
    for (int j = 0; j < kPoints; ++j) {
      const double other = (j + 0.5) / kPoints;
      sum += other * h[static_cast<std::size_t>(j)] / (mu + other) / kPoints;
    }
    return 1 / (root + 0.45 * sum);
  };
  for (int pass = 0; pass < 30; ++pass) {
    std::vector<double> next;
    for (int i = 0; i < kPoints; ++i)
      next.push_back(at((i + 0.5) / kPoints));
    h = next;
  }
  const SlabLight light = Slab({0, 0.9}).light(1e4);
  EXPECT_NEAR(light.reflectance, 1 - at(1) * root, 2e-5);
  EXPECT_LT(light.transmittance, 1e-12);
}

TEST(Slab, HardlyDependsOnTheNumberOfOrdinates) {
  const SlabLight a = Slab({0.9, 0.97}, 64).light(4), b = Slab({0.9, 0.97}, 96).light(4);
  EXPECT_NEAR(a.reflectance, b.reflectance, 1e-7);
  EXPECT_NEAR(a.transmittance, b.transmittance, 1e-7);
  EXPECT_NEAR(a.transmission[0], b.transmission[0], 1e-4 * b.transmission[0]);
}

TEST(Slab, OfThinMediumShowsThePhaseFunction) {
  const double depth = 1e-4;
  const SlabLight light = Slab({0.8, 0.9}).light(depth);
  for (std::size_t i = 0; i < light.cosine.size() && light.cosine[i] > 0.2; ++i) {
    const double once = 0.9 * depth / light.cosine[i];
    // Scattered twice: a share of about τ/μ.
    EXPECT_NEAR(light.transmission[i], once * henyey_greenstein(light.cosine[i], 0.8), 1e-3 * once) << light.cosine[i];
    EXPECT_NEAR(light.reflection[i], once * henyey_greenstein(-light.cosine[i], 0.8), 1e-3 * once);
  }
}

/// Photons through a slab, and how many leave within 30° of straight on.
struct Counted {
  double reflected = 0, transmitted = 0, ahead = 0;
};
Counted count(const SlabMedium& medium, double depth, int photons, std::uint32_t seed) {
  Counted out;
  Random random(seed);
  const double g = medium.anisotropy;
  for (int i = 0; i < photons; ++i) {
    glm::dvec3 direction(0, 0, 1);
    double z = 0, weight = 1;
    while (true) {
      z -= direction.z * std::log(1 - static_cast<double>(random.next()));
      if (z < 0 || z > depth) break;
      weight *= medium.albedo;
      if (weight < 0.1) {
        if (random.next() > 0.5F) {
          weight = 0;
          break;
        }
        weight *= 2;
      }
      const double u = static_cast<double>(random.next());
      const double s = (1 - g * g) / (1 - g + 2 * g * u);
      const double cosine = std::abs(g) < 1e-3 ? 2 * u - 1 : (1 + g * g - s * s) / (2 * g);
      const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
      const double turn = 2 * pi * static_cast<double>(random.next());
      const glm::dvec3 side = glm::normalize(
          glm::cross(direction, std::abs(direction.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
      direction = glm::normalize(cosine * direction +
                                 sine * (std::cos(turn) * side + std::sin(turn) * glm::cross(direction, side)));
    }
    if (z < 0) out.reflected += weight;
    if (z > depth) {
      out.transmitted += weight;
      if (direction.z > std::cos(pi / 6)) out.ahead += weight;
    }
  }
  out.reflected /= photons;
  out.transmitted /= photons;
  out.ahead /= photons;
  return out;
}

TEST(Slab, AgreesWithPhotonsAtTenPoints) {
  struct Point {
    double anisotropy, albedo, depth;
  };
  const Point points[] = {{0.95, 1, 30},  {0, 1, 1},        {0.8, 1, 7},  {0.8, 0.9, 3},   {0.5, 0.99, 10},
                          {-0.5, 0.8, 2}, {0.9, 0.95, 0.2}, {0.99, 1, 5}, {0.7, 0.3, 1.5}, {0.95, 0.99, 12}};
  constexpr int kPhotons = 60000;
  // A weight in [0, 2] has a variance of at most twice its mean; 30 numbers are compared, so 3.8 standard errors each
  // leave one such test in 250 to chance, and the seed is fixed.
  const auto within = [&](double mean) { return 3.8 * std::sqrt(std::max(mean * (1 - 0.5 * mean), 1e-4) / kPhotons); };
  std::uint32_t seed = 7;
  for (const Point& p : points) {
    const SlabLight light = Slab({p.anisotropy, p.albedo}).light(p.depth);
    const Counted counted = count({p.anisotropy, p.albedo}, p.depth, kPhotons, seed++);
    EXPECT_NEAR(light.reflectance, counted.reflected, within(light.reflectance)) << p.anisotropy << " " << p.depth;
    EXPECT_NEAR(light.transmittance, counted.transmitted, within(light.transmittance))
        << p.anisotropy << " " << p.depth;
    // The radiance by angle, summed as far as 30°, where one ordinate's bin is cut in proportion.
    double ahead = light.unscattered + light.near_forward, cosine = 1;
    for (std::size_t i = 0; i < light.cosine.size(); ++i) {
      const double part = std::clamp((cosine - std::cos(pi / 6)) / light.weight[i], 0.0, 1.0);
      ahead += 2 * pi * part * light.weight[i] * light.cosine[i] * light.transmission[i];
      cosine -= light.weight[i];
    }
    EXPECT_NEAR(ahead, counted.ahead, within(ahead) + 0.004) << p.anisotropy << " " << p.depth;
  }
}

TEST(Slab, RefusesWhatIsNoMedium) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double g : {1.0, -1.0, 1.5, nan})
    EXPECT_THROW(Slab({g, 0.5}), InputError) << g;
  for (const double albedo : {-0.01, 1.01, nan})
    EXPECT_THROW(Slab({0.5, albedo}), InputError) << albedo;
  const Slab slab({0.5, 0.5});
  for (const double depth : {-1e-9, nan, std::numeric_limits<double>::infinity()})
    EXPECT_THROW(slab.light(depth), InputError) << depth;
}

TEST(TransferFit, KeepsTheEnergyOfTheSlab) {
  for (const TransferModel model :
       {TransferModel::gaussian, TransferModel::unscattered, TransferModel::two_gaussians}) {
    const Slab slab({0.85, 0.95});
    for (const double depth : {0.0, 0.01, 0.5, 2.0, 9.0, 200.0}) {
      const SlabLight light = slab.light(depth);
      const TransferFit fit = fit_transfer(light, model);
      EXPECT_NEAR(fit.sharp + fit.f_t + fit.f_2 + fit.c_t, light.transmittance, 1e-9);
      EXPECT_NEAR(fit.c_r, light.reflectance, 1e-12);
      for (const double part : {fit.sharp, fit.f_t, fit.f_2, fit.c_t})
        EXPECT_GE(part, -1e-12) << depth;
    }
  }
}

TEST(TransferFit, ModelsWithMorePartsFitBetter) {
  const Slab slab({0.9, 1});
  for (const double depth : {0.1, 0.5, 1.0}) {
    const SlabLight light = slab.light(depth);
    const double one = fit_transfer(light, TransferModel::gaussian).rms;
    EXPECT_LT(fit_transfer(light, TransferModel::unscattered).rms, 0.6 * one) << depth;
    EXPECT_LT(fit_transfer(light, TransferModel::two_gaussians).rms, one) << depth;
  }
}

TEST(TransferFit, WidensWithTheSlab) {
  const Slab slab({0.9, 1});
  double before = 0;
  for (const double depth : {0.8, 1.0, 2.0, 4.0, 8.0, 16.0}) {
    const double width = fit_transfer(slab.light(depth), TransferModel::gaussian).theta_bar;
    EXPECT_GT(width, before) << depth;
    before = width;
  }
}

TEST(TransferFit, GaussianWithinAnAngleIsTheIntegral) {
  // Narrow: the plane's 1 − exp(−θ²/2σ²). Wide: nearly the sphere's (1 − cos θ)/2.
  EXPECT_NEAR(gaussian_within(0.01, 0.015), 1 - std::exp(-0.5 * 1.5 * 1.5), 1e-4);
  EXPECT_NEAR(gaussian_within(1e3, 1.0), 0.5 * (1 - std::cos(1.0)), 1e-4);
}

TEST(TransferTable, InterpolatesTheFits) {
  const TransferTable table({0.8, 0.95}, TransferModel::unscattered);
  const Slab slab({0.8, 0.95});
  for (const double depth : {0.0, 0.03, 0.7, 2.5, 11.0}) {
    const TransferFit fit = fit_transfer(slab.light(depth), TransferModel::unscattered), got = table.at(depth);
    EXPECT_NEAR(got.sharp, fit.sharp, 1e-3) << depth;
    EXPECT_NEAR(got.f_t, fit.f_t, 3e-3) << depth;
    EXPECT_NEAR(got.c_r, fit.c_r, 1e-3) << depth;
  }
  EXPECT_LT(table.at(1e6).f_t, 1e-6);
}

}  // namespace
}  // namespace pellucid::scattering
