// The searches in GLSL: equal steps against its C++ twin, the others against exact rays.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/reference/relief/height_field.hpp"
#include "algorithms/translucent_relief/height_pyramid.hpp"
#include "algorithms/translucent_relief/search.hpp"
#include "gl/program.hpp"
#include "tests/algorithms/compute.hpp"
#include "tests/algorithms/relief_scenes.hpp"
#include "tests/algorithms/rendered.hpp"

namespace pellucid {
namespace {

struct SearchInput {
  glm::vec3 origin;
  float begin;
  glm::vec3 direction;
  float end;
  glm::vec2 uv;
  float side, steps, refinements, pad[3];
};
struct SearchOutput {
  float linear, taken, max_mip, cone, relaxed;
};

constexpr int kTexels = 32;

std::vector<SearchInput> search_inputs() {
  std::mt19937 random(29);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  std::vector<SearchInput> all;
  for (int i = 0; i < 4096; ++i) {
    SearchInput q{};
    q.side = i % 3 == 0 ? -1.0F : 1.0F;
    q.origin = {0.0F, 0.0F, q.side > 0 ? 0.0F : -0.3F};
    q.direction = glm::normalize(glm::vec3{unit(random) - 0.5F, unit(random) - 0.5F, -q.side * (0.05F + unit(random))});
    q.uv = {unit(random), unit(random)};
    q.begin = 0.1F * unit(random);
    q.end = i % 17 == 0 ? q.begin : q.begin + unit(random);
    q.steps = static_cast<float>(1 + i % 40);
    q.refinements = static_cast<float>(i % 7);
    all.push_back(q);
  }
  return all;
}

ReliefRay ray_of(const SearchInput& q) {
  return {glm::dvec3(q.origin), glm::dvec3(q.direction), glm::dvec2(q.uv), glm::dvec2(1.0)};
}

class ReliefSearch : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    test::use_context();
    const Image field = test::random_field(kTexels, 7);
    layer = test::layer_of(field, -0.3F, 0.0F);
    gl::Texture heights = gl::Texture::make_2d("field", gl::Format::r32f, kTexels, kTexels);
    heights.upload(field.pixels);
    heights.set_sampling(gl::Filter::linear, gl::Wrap::repeat);
    heights.bind(3);
    const std::vector<Image> levels = translucent_relief::height_pyramid(field);
    gl::Texture pyramid =
        gl::Texture::make_2d("pyramid", gl::Format::rg32f, kTexels, kTexels, static_cast<int>(levels.size()));
    for (std::size_t i = 0; i < levels.size(); ++i)
      pyramid.upload(levels[i].pixels, static_cast<int>(i));
    pyramid.bind(4);
    gl::Texture cones = gl::Texture::make_2d("cones", gl::Format::rg32f, kTexels, kTexels);
    cones.upload(translucent_relief::relaxed_cone_map(field).pixels);
    cones.set_sampling(gl::Filter::linear, gl::Wrap::repeat);
    cones.bind(5);
    in = search_inputs();
    out = test::compute<SearchOutput>(gl::Program("relief search", {"tests/algorithms/relief_search.comp.glsl"}), in);
  }
  inline static ReliefLayer layer;
  inline static std::vector<SearchInput> in;
  inline static std::vector<SearchOutput> out;
};

TEST_F(ReliefSearch, EqualStepsAgreeWithTheirTwin) {
  const HeightField exact(layer, glm::dvec2(1.0));
  int hits = 0, differ = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const SearchInput& q = in[i];
    const ReliefRay ray = ray_of(q);
    const auto crossing = translucent_relief::linear_crossing(
        [&](float t) {
          const double at = static_cast<double>(t);
          return static_cast<float>(ray.at(at).z - exact.height_m(ray.uv_at(at)));
        },
        {q.begin, q.end}, q.side, 1e-6F, static_cast<int>(q.steps), static_cast<int>(q.refinements));
    hits += crossing.at >= 0 ? 1 : 0;
    // Where a sample lies on the surface to a rounding, one finds it in this step and the other in the next.
    if (std::abs(out[i].linear - crossing.at) > 2e-4F || out[i].taken != static_cast<float>(crossing.taken)) ++differ;
  }
  EXPECT_GT(hits, 1000);
  EXPECT_LE(differ, 12) << "of " << in.size();
}

// A range of no length, or one that begins beneath the surface, is left out: there the rules differ.
TEST_F(ReliefSearch, ThePyramidIsExact) {
  const HeightField exact(layer, glm::dvec2(1.0));
  int hits = 0, differ = 0, asked = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const SearchInput& q = in[i];
    const ReliefRay ray = ray_of(q);
    const double begin = static_cast<double>(q.begin), end = static_cast<double>(q.end);
    const double start = static_cast<double>(q.side) * (ray.at(begin).z - exact.height_m(ray.uv_at(begin)));
    if (end <= begin || start < 1e-4) continue;
    ++asked;
    const auto truth = exact.crossing(ray, begin, end, static_cast<double>(q.side));
    hits += truth ? 1 : 0;
    if (std::abs(static_cast<double>(out[i].max_mip) - truth.value_or(-1.0)) > 1e-4) ++differ;
  }
  EXPECT_GT(hits, 700);
  // A ray that grazes a crest meets it or not by a rounding.
  EXPECT_LE(differ, asked / 500) << "of " << asked;
}

TEST_F(ReliefSearch, ConesStopAtTheSurface) {
  const HeightField exact(layer, glm::dvec2(1.0));
  int hits = 0, missed = 0, missed_relaxed = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const SearchInput& q = in[i];
    if (q.side < 0) continue;
    const ReliefRay ray = ray_of(q);
    const double begin = static_cast<double>(q.begin), end = static_cast<double>(q.end);
    if (end <= begin || ray.at(begin).z - exact.height_m(ray.uv_at(begin)) < 1e-4) continue;
    const auto truth = exact.crossing(ray, begin, end, 1.0);
    if (!truth) continue;
    ++hits;
    if (std::abs(static_cast<double>(out[i].cone) - *truth) > 3e-3) ++missed;
    if (std::abs(static_cast<double>(out[i].relaxed) - *truth) > 3e-3) ++missed_relaxed;
  }
  EXPECT_GT(hits, 500);
  // The cones are of texel centres, and between them they are interpolated: a few steps are too long.
  EXPECT_LE(missed, hits / 50) << "of " << hits;
  EXPECT_LE(missed_relaxed, hits / 50) << "of " << hits;
}

// A map that is too large is halved; the cones over any of its texels must be empty of the map that was given.
TEST(ReliefCones, OfReducedMapsAreEmpty) {
  constexpr int kSide = 2 * translucent_relief::kMostConeTexels;
  const Image field = test::random_field(kSide, 11, 4);
  const Image cones = translucent_relief::cone_map(field);
  ASSERT_EQ(cones.width, translucent_relief::kMostConeTexels);
  std::mt19937 random(5);
  std::uniform_int_distribution<int> any(0, kSide - 1);
  int wide = 0, blocked = 0;
  for (int i = 0; i < 100; ++i) {
    const int x = any(random), y = any(random);
    const float apex = *field.at(x, y), cone = *cones.at(x / 2, y / 2);
    wide += cone > 0.05F ? 1 : 0;
    for (int v = 0; v < kSide; ++v) {
      for (int u = 0; u < kSide; ++u) {
        const auto away = [](int a, int b) { return std::min(std::abs(a - b), kSide - std::abs(a - b)); };
        const float distance = std::hypot(static_cast<float>(away(u, x)), static_cast<float>(away(v, y))) / kSide;
        if ((*field.at(u, v) - apex) * cone > distance + 1e-6F) ++blocked;
      }
    }
  }
  EXPECT_EQ(blocked, 0);
  EXPECT_GT(wide, 50) << "cones that are all narrow would be of no use";
}

// Falling rays from any height over a texel come out of the solid outside of its relaxed cone, if at all.
TEST(ReliefCones, RelaxedOnesArePiercedOnce) {
  constexpr int kSide = 64;
  const Image field = test::random_field(kSide, 11, 4);
  const ReliefLayer layer = test::layer_of(field, -1.0F, 0.0F);
  const HeightField heights(layer, glm::dvec2(1.0));
  const Image cones = translucent_relief::relaxed_cone_map(field);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  double empty = 0, relaxed = 0;
  int left = 0, inside = 0;
  for (int i = 0; i < 4000; ++i) {
    const int x = static_cast<int>(unit(random) * kSide), y = static_cast<int>(unit(random) * kSide);
    const double apex = static_cast<double>(*field.at(x, y)), ratio = static_cast<double>(cones.at(x, y)[1]);
    empty += static_cast<double>(cones.at(x, y)[0]);
    relaxed += ratio;
    const double angle = 6.2831853 * unit(random), origin = apex + (1 - apex) * unit(random), fall = 2 * unit(random);
    const glm::dvec2 from = (glm::dvec2(x, y) + 0.5) / static_cast<double>(kSide);
    bool entered = false;
    for (double away = 0.002; away < 1; away += 0.002) {
      const glm::dvec2 at = from + away * glm::dvec2(std::cos(angle), std::sin(angle));
      const double height = heights.height_m(at) + 1, z = origin - fall * away;
      if (z < 0) break;
      entered = entered || z < height;
      if (!entered || z < height || z <= apex) continue;
      ++left;
      inside += (away + 1.0 / kSide) / (z - apex) < ratio ? 1 : 0;
      break;
    }
  }
  EXPECT_GT(left, 500);
  // Rays between the directions and heights that the map asks.
  EXPECT_LE(inside, left / 50) << "of " << left;
  EXPECT_GT(relaxed, 1.2 * empty);
}

}  // namespace
}  // namespace pellucid
