// The hit search of distance impostors: against closed forms, and GLSL against C++.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "algorithms/local_cube_maps/hit_search.hpp"
#include "gl/context.hpp"
#include "gl/cube_faces.hpp"
#include "gl/program.hpp"
#include "tests/algorithms/compute.hpp"

namespace pellucid::local_cube_maps {
namespace {

constexpr double kTexelDeg = 180.0 / std::numbers::pi;

double angle(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

class Random {
 public:
  explicit Random(unsigned seed) : random_(seed) {}
  double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  double between(double low, double high) { return low + (high - low) * unit(); }
  glm::dvec3 direction() {
    std::normal_distribution<double> normal;
    return glm::normalize(glm::dvec3{normal(random_), normal(random_), normal(random_)});
  }
  glm::dvec3 in_box(double half) { return {between(-half, half), between(-half, half), between(-half, half)}; }

 private:
  std::mt19937 random_;
};

// The room of impostor_twins.comp.glsl.
template <class Real>
Real box_distance(const glm::vec<3, Real>& direction) {
  const glm::vec<3, Real> d = direction / glm::length(direction);
  const glm::vec<3, Real> middle(Real(0.3), Real(-0.2), Real(0.1)), half(2, Real(1.5), Real(2.5));
  const glm::vec<3, Real> away = (middle + glm::sign(d) * half) / d;
  return std::min(away.x, std::min(away.y, away.z));
}
glm::dvec3 box_hit(const glm::dvec3& x, const glm::dvec3& R) {
  const glm::dvec3 middle(0.3, -0.2, 0.1), half(2, 1.5, 2.5);
  const glm::dvec3 away = (middle + glm::sign(R) * half - x) / R;
  return x + R * std::min(away.x, std::min(away.y, away.z));
}

struct Plane {
  glm::dvec3 normal;
  double away;
  double distance(const glm::dvec3& direction) const {
    const double slope = glm::dot(normal, direction) / glm::length(direction);
    return slope > 0 ? away / slope : 1e9;
  }
};

// Where the hit, the default point r and o see one plane, d_l solves the ray exactly (Sec. 2.1).
TEST(ImpostorHitSearch, APlaneIsExactAfterTheSecondGuess) {
  Random random(1);
  double first_guess = 0;
  int rays = 0;
  while (rays < 2000) {
    const Plane plane{random.direction(), random.between(0.5, 3)};
    const glm::dvec3 x = random.in_box(0.4) * plane.away, R = random.direction();
    if (glm::dot(R, plane.normal) < 0.2) continue;
    const glm::dvec3 exact = x + R * ((plane.away - glm::dot(plane.normal, x)) / glm::dot(plane.normal, R));
    const auto distance = [&](const glm::dvec3& d) { return plane.distance(d); };
    // The first guess must lie before the plane's horizon, too: p' is then a point of it.
    const glm::dvec3 p = find_hit(x, R, distance, {-1, Scheme::false_position, 64});
    if (glm::dot(p, plane.normal) < 0.05 * glm::length(p)) continue;
    ++rays;
    EXPECT_LT(glm::distance(find_hit(x, R, distance, {0, Scheme::false_position, 64}), exact), 1e-9 * plane.away);
    first_guess += glm::distance(p, exact) / plane.away;
  }
  EXPECT_GT(first_guess / rays, 0.05);  // d_p alone is not
}

// The same with the distances of a cube map, one for each texel: to one texel's angle.
TEST(ImpostorHitSearch, APlaneInACubeMapIsExactToATexel) {
  constexpr int kSize = 256;
  Random random(2);
  const Plane plane{glm::normalize(glm::dvec3(0.1, 0.2, 1)), 2};
  std::vector<double> texels;
  for (int face = 0; face < gl::kCubeFaces; ++face) {
    for (int t = 0; t < kSize; ++t) {
      for (int s = 0; s < kSize; ++s)
        texels.push_back(plane.distance(gl::cube_direction({face, (s + 0.5) / kSize, (t + 0.5) / kSize})));
    }
  }
  const auto nearest = [&](const glm::dvec3& direction) {
    const gl::CubeTexel texel = gl::cube_texel(direction);
    const auto at = [](double v) { return std::min(static_cast<int>(v * kSize), kSize - 1); };
    return texels[static_cast<std::size_t>((texel.face * kSize + at(texel.t)) * kSize + at(texel.s))];
  };
  const double texel_angle = 2.0 / kSize;
  int rays = 0;
  double worst = 0;
  while (rays < 2000) {
    const glm::dvec3 x = random.in_box(0.7), R = random.direction();
    if (glm::dot(R, plane.normal) < 0.7) continue;
    const glm::dvec3 exact = x + R * ((plane.away - glm::dot(plane.normal, x)) / glm::dot(plane.normal, R));
    if (glm::dot(exact, plane.normal) < 0.7 * glm::length(exact)) continue;
    ++rays;
    worst = std::max(worst, angle(find_hit(x, R, nearest, {0, Scheme::false_position, 64}), exact));
  }
  EXPECT_LT(worst, texel_angle) << worst * kTexelDeg << " degrees";
}

TEST(ImpostorHitSearch, EverySchemeConvergesInARoundRoom) {
  Random random(3);
  const auto distance = [](const glm::dvec3&) { return 1.7; };
  for (const Scheme scheme : {Scheme::secant, Scheme::false_position, Scheme::linear, Scheme::linear_false_position}) {
    double before = 1e9;
    for (const int iterations : {0, 2, 6, 14}) {
      Random rays(4);
      double worst = 0, mean = 0;
      for (int i = 0; i < 1000; ++i) {
        const glm::dvec3 x = rays.in_box(0.7), R = rays.direction();
        const double along = glm::dot(x, R);
        const glm::dvec3 exact = x + R * (std::sqrt(along * along - glm::dot(x, x) + 1.7 * 1.7) - along);
        const double error = glm::distance(find_hit(x, R, distance, {iterations, scheme, 64}), exact);
        worst = std::max(worst, error);
        mean += error / 1000;
      }
      EXPECT_LE(mean, before) << static_cast<int>(scheme) << " after " << iterations;
      before = mean;
      if (iterations == 14) {
        EXPECT_LT(mean, 1e-4) << static_cast<int>(scheme);
        EXPECT_LT(worst, 0.02) << static_cast<int>(scheme);
      }
    }
  }
}

// From the centre itself every guess is exact.
TEST(ImpostorHitSearch, FromTheReferencePointTheDirectionIsEnough) {
  Random random(5);
  const auto distance = [](const glm::dvec3& d) { return box_distance(d); };
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 R = random.direction();
    for (const Scheme scheme :
         {Scheme::secant, Scheme::false_position, Scheme::linear, Scheme::linear_false_position}) {
      for (const int iterations : {-1, 0, 3})
        EXPECT_LT(glm::distance(find_hit(glm::dvec3(0), R, distance, {iterations, scheme, 16}), box_hit({}, R)), 1e-9);
    }
  }
}

// Sec. 2.2: false position gets worse with another iteration on no more than a hundredth of the rays.
TEST(ImpostorHitSearch, FalsePositionSeldomGetsWorse) {
  constexpr int kRays = 20000;
  const auto distance = [](const glm::dvec3& d) { return box_distance(d); };
  for (int iterations = 0; iterations < 8; ++iterations) {
    Random random(6);
    int worse = 0;
    for (int i = 0; i < kRays; ++i) {
      // Mirror ball of half a metre anywhere it fits.
      const glm::dvec3 n = random.direction();
      const glm::dvec3 ball(random.between(-1.1, 1.7), random.between(-1.1, 0.7), random.between(-1.8, 2.0));
      const glm::dvec3 x = ball + 0.5 * n;
      glm::dvec3 R = random.direction();
      if (glm::dot(R, n) < 0) R = -R;
      const glm::dvec3 q = box_hit(x, R);
      const auto error = [&](int count) {
        return angle(find_hit(x, R, distance, {count, Scheme::false_position, 64}), q);
      };
      if (error(iterations + 1) > error(iterations) + 0.001) ++worse;  // a quarter of a texel of a 512 cube
    }
    EXPECT_LE(worse, kRays / 100) << "from " << iterations << " to " << iterations + 1;
  }
}

// An object outside the room that its cube map shows, or on its wall: no flight to infinity, nothing that is no number.
TEST(ImpostorHitSearch, BeyondTheWallsItStaysFinite) {
  Random random(7);
  const auto distance = [](const glm::dvec3& d) { return box_distance(d); };
  for (int i = 0; i < 5000; ++i) {
    const glm::dvec3 far = random.direction() * random.between(0.1, 30);
    const glm::dvec3 x = i % 3 == 0 ? box_hit({}, glm::normalize(far)) : far, R = random.direction();
    for (const Scheme scheme :
         {Scheme::secant, Scheme::false_position, Scheme::linear, Scheme::linear_false_position}) {
      for (const int iterations : {-1, 0, 2, 32}) {
        const glm::dvec3 l = find_hit(x, R, distance, {iterations, scheme, 32});
        EXPECT_TRUE(std::isfinite(l.x) && std::isfinite(l.y) && std::isfinite(l.z));
      }
    }
  }
}

struct Ray {
  glm::vec4 x, direction;
};

std::vector<glm::vec4> run_on_gpu(const std::vector<Ray>& rays, int room, const HitSearch& search) {
  const gl::Program program("hit search", {"tests/algorithms/distance_impostors/impostor_twins.comp.glsl"},
                            {{"ROOM", fmt::to_string(room)},
                             {"ITERATIONS", fmt::to_string(search.iterations)},
                             {"SCHEME", fmt::to_string(static_cast<int>(search.scheme))},
                             {"LINEAR_STEPS", fmt::to_string(search.steps)}});
  return test::compute<glm::vec4>(program, rays);
}

TEST(ImpostorHitSearch, ShaderAgreesWithItsTwin) {
  const gl::Context context;
  Random random(8);
  std::vector<Ray> rays;
  for (int i = 0; i < 4096; ++i) {
    const double reach = i % 5 == 0 ? 0 : i % 7 == 0 ? 4 : 1.2;  // at o, beyond the walls, within
    rays.push_back({glm::vec4(glm::vec3(random.in_box(1) * reach), 0), glm::vec4(glm::vec3(random.direction()), 0)});
  }
  for (const Scheme scheme : {Scheme::secant, Scheme::false_position, Scheme::linear, Scheme::linear_false_position}) {
    for (const int iterations : {-1, 0, 1, 2, 5, 12}) {
      for (const int room : {0, 1}) {
        const HitSearch search{iterations, scheme, 24};
        const std::vector<glm::vec4> hits = run_on_gpu(rays, room, search);
        int differ = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const auto distance = [&](const glm::vec3& d) { return room == 0 ? box_distance(d) : 1.7F; };
          const glm::vec3 twin = find_hit(glm::vec3(rays[i].x), glm::vec3(rays[i].direction), distance, search);
          ASSERT_TRUE(std::isfinite(hits[i].x + hits[i].y + hits[i].z)) << i;
          if (!(glm::distance(twin, glm::vec3(hits[i])) < 1e-3F * (1 + glm::length(twin)))) ++differ;
        }
        // Rounding decides at edges, and which step a search takes there.
        EXPECT_LE(differ, static_cast<int>(rays.size()) / 200)
            << "scheme " << static_cast<int>(scheme) << ", " << iterations << " iterations, room " << room;
      }
    }
  }
}

}  // namespace
}  // namespace pellucid::local_cube_maps
