// GLSL functions against their C++ twins.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "algorithms/sampling_hulls/sampling_hulls.hpp"
#include "algorithms/shaders/opacity.hpp"
#include "algorithms/shaders/shadows.hpp"
#include "algorithms/shaders/valid_path.hpp"
#include "gl/program.hpp"
#include "tests/algorithms/compute.hpp"
#include "tests/algorithms/rendered.hpp"

namespace pellucid {
namespace {

struct ShaderInput {
  float extinction, interval, step, offset;
  glm::vec3 s;
  float count;
  glm::vec3 sf;
  float i;
  glm::vec3 ray;
  float opacity;
};
struct ShaderOutput {
  float voxel, corrected, step, path, sample_at, half_way_behind, half_way_before, pad;
};

// Random media and paths, and with them every declared extreme of N and of the sample's place.
std::vector<ShaderInput> shader_inputs() {
  const auto infos = parameter_table<sampling_hulls::Parameters>().infos();
  auto bound = [&](std::string_view name, bool high) {
    for (const auto& p : infos) {
      if (p.name == name) return static_cast<float>(high ? p.max : p.min);
    }
    throw std::logic_error("no such parameter");
  };
  std::mt19937 random(11);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  std::vector<ShaderInput> all;
  for (int k = 0; k < 4096; ++k) {
    ShaderInput q{};
    q.extinction = k % 7 == 0 ? 0.0F : std::pow(10.0F, 6.0F * unit(random) - 4.0F);
    q.interval = std::pow(10.0F, 3.0F * unit(random) - 2.0F);
    q.step = k % 11 == 0 ? 0.0F : std::pow(10.0F, 4.0F * unit(random) - 3.0F);
    q.offset = k % 3 == 0 ? bound("sample_offset", false) : k % 3 == 1 ? bound("sample_offset", true) : unit(random);
    q.count = k % 4 == 0   ? bound("samples", false)
              : k % 4 == 1 ? bound("samples", true)
                           : std::floor(1 + 31 * unit(random));
    q.i = std::floor(unit(random) * q.count);
    q.s = {unit(random), unit(random), unit(random)};
    q.sf = {unit(random), unit(random), unit(random)};
    q.ray = glm::normalize(glm::vec3{unit(random), unit(random), unit(random)} - glm::vec3(0.5F));
    q.opacity = k % 13 == 0 ? 1.0F : k % 17 == 0 ? 0.0F : unit(random);
    all.push_back(q);
  }
  return all;
}

TEST(ShaderTwins, OpacityAndValidPath) {
  test::use_context();
  const std::vector<ShaderInput> in = shader_inputs();
  const gl::Program program("twins", {"tests/algorithms/opacity.comp.glsl"});
  const std::vector<ShaderOutput> out = test::compute<ShaderOutput>(program, in);
  int clipped = 0, held_at_back = 0, held_at_front = 0;
  for (std::size_t k = 0; k < in.size(); ++k) {
    const ShaderInput& q = in[k];
    EXPECT_NEAR(out[k].voxel, voxel_opacity(q.extinction, q.interval), 2e-6) << k;
    EXPECT_NEAR(out[k].step, step_opacity(q.extinction, q.step), 2e-6) << k;
    // pow is exp2(r·log2(1 − α)): the logarithm's absolute error of a few 2^-22 counts r-fold.
    const double steps = static_cast<double>(q.step) / q.interval;
    const double left = 1 - corrected_opacity(q.opacity, steps);
    EXPECT_NEAR(out[k].corrected, 1 - left, 3e-6 + 1e-6 * steps * left) << k;
    const double path = valid_path_length(q.s, q.sf, q.ray);
    clipped += path == 0 ? 1 : 0;
    EXPECT_NEAR(out[k].path, path, 1e-6) << k;
    EXPECT_NEAR(out[k].sample_at, sample_distance(path, q.i, q.count, q.offset), 2e-6) << k;
    EXPECT_NEAR(out[k].half_way_behind, half_way_distance(path, q.i, q.count, q.offset), 2e-6) << k;
    EXPECT_NEAR(out[k].half_way_before, half_way_distance(path, q.i + 1, q.count, q.offset), 2e-6) << k;
    held_at_back += path > 0 && out[k].half_way_behind == out[k].path ? 1 : 0;
    held_at_front += path > 0 && out[k].half_way_before == 0 ? 1 : 0;
  }
  EXPECT_GT(clipped, 1000) << "paths that rounding turned round must be among the inputs";
  EXPECT_LT(clipped, 3000);
  EXPECT_GT(held_at_back, 100) << "half-way points beyond either end of the path must be among them";
  EXPECT_GT(held_at_front, 100);
}

// ---- the whole path ----

struct Path {
  float length, samples, offset, extinction;
  glm::vec4 shadow_edges;
};

// Share of each light at x, as path.comp.glsl has it.
glm::dvec4 visible_at(const Path& path, double x) {
  glm::dvec4 visible;
  for (int i = 0; i < 4; ++i) {
    const auto edge = static_cast<double>(path.shadow_edges[i]);
    visible[i] = (edge < 0 ? x >= -edge : x <= edge) ? 1 : 0;
  }
  return visible;
}

// Eq. 1 to 6 and Fig. 7, point after point from the back.
glm::dvec4 composite(const Path& path, double& nearest_edge) {
  const auto length = static_cast<double>(path.length), count = static_cast<double>(path.samples);
  glm::dvec3 color(0.0);
  double transmittance = 1;
  const auto rate = [&](double x) {
    for (int i = 0; i < 4; ++i)
      nearest_edge = std::min(nearest_edge, std::abs(x - std::abs(static_cast<double>(path.shadow_edges[i]))));
    return visible_at(path, x);
  };
  for (int i = 0; i < static_cast<int>(path.samples); ++i) {
    const double x = sample_distance(length, i, count, path.offset);
    glm::dvec4 visible;
    const glm::dvec4 behind = rate(half_way_distance(length, i, count, path.offset)), at = rate(x),
                     before = rate(half_way_distance(length, i + 1, count, path.offset));
    for (int c = 0; c < 4; ++c)
      visible[c] = filtered_occlusion(behind[c], at[c], before[c]);
    const double opacity = step_opacity(static_cast<double>(path.extinction) * (1 + x), length / count);
    color = opacity * (glm::dvec3(visible) + glm::dvec3(visible.w, 0, 0)) + (1 - opacity) * color;
    transmittance *= 1 - opacity;
  }
  return {color, transmittance};
}

// The shader's own loop, over shadows with edges at random places: N = 1 and 2, where a point has both ends of the path
// for neighbours, every place of the points in their steps, and paths of no length.
TEST(ShaderTwins, PathWithFilteredOcclusion) {
  test::use_context();
  std::mt19937 random(17);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  std::vector<Path> all;
  while (all.size() < 4096) {
    const auto k = static_cast<int>(all.size());
    Path path{};
    path.length = k % 31 == 0 ? 0.0F : 0.1F + 5.0F * unit(random);
    path.samples = static_cast<float>(k % 5 == 0 ? 1 : k % 5 == 1 ? 2 : 3 + k % 14);
    path.offset = k % 3 == 0 ? 0.0F : k % 3 == 1 ? 1.0F : unit(random);
    path.extinction = k % 7 == 0 ? 0.0F : 2.0F * unit(random);
    for (int i = 0; i < 4; ++i)
      path.shadow_edges[i] =
          (0.02F + 1.1F * unit(random)) * std::max(path.length, 0.1F) * (unit(random) < 0.5F ? -1 : 1);
    double nearest_edge = 1e9;
    composite(path, nearest_edge);
    if (nearest_edge > 1e-4) all.push_back(path);  // else rounding decides on which side of an edge a point lies
  }
  const gl::Program program("path", {"tests/algorithms/path.comp.glsl"});
  const std::vector<glm::vec4> outputs = test::compute<glm::vec4>(program, all);
  for (std::size_t k = 0; k < all.size(); ++k) {
    double unused = 0;
    const glm::dvec4 expected = composite(all[k], unused);
    for (int c = 0; c < 4; ++c)
      EXPECT_NEAR(outputs[k][c], expected[c], 1e-5) << k << " of " << all[k].samples << " samples";
  }
}

// One point sees a shadow's edge that lies between it and an end of its path as a quarter of the light.
TEST(Occlusion, OnePointWeighsTheEndsOfItsPath) {
  Path path{1.0F, 1.0F, 0.5F, 1.0F, glm::vec4(0.75F, -0.75F, 0.25F, -0.25F)};
  double unused = 0;
  const glm::dvec4 lit = composite(path, unused);
  const double opacity = step_opacity(1.5, 1.0);
  EXPECT_NEAR(lit.y, 0.25 * opacity, 1e-12) << "only the back end is lit";
  EXPECT_NEAR(lit.z, 0.25 * opacity, 1e-12) << "only the front end is lit";
  EXPECT_NEAR(lit.x, (0.75 + 0.75) * opacity, 1e-12);
  path.offset = 0;  // as in the paper: the point at the back, held there too, and the half-way point before it
  path.shadow_edges = glm::vec4(0.75F, -0.75F, 0.25F, -0.25F);
  const glm::dvec4 paper = composite(path, unused);
  EXPECT_NEAR(paper.y, 0.75 * step_opacity(2.0, 1.0), 1e-12);
  EXPECT_NEAR(paper.z, 0.0, 1e-12);
}

// Eq. 6 of Eq. 5 is the step's own opacity: Δd0 cancels.
TEST(OpacityCorrection, CancelsTheVoxelInterval) {
  for (double extinction : {0.01, 0.5, 3.0}) {
    for (double interval : {0.1, 1.0}) {
      for (double step : {0.0, 0.01, 0.7, 4.0}) {
        EXPECT_NEAR(corrected_opacity(voxel_opacity(extinction, interval), step / interval),
                    step_opacity(extinction, step), 1e-12);
      }
    }
  }
  EXPECT_EQ(corrected_opacity(1.0, 0.0), 0.0);
  EXPECT_EQ(corrected_opacity(1.0, 1e-3), 1.0);
  EXPECT_EQ(corrected_opacity(0.0, 5.0), 0.0);
}

TEST(ValidPath, SamplesRunFromTheBackToOneStepBehindTheFront) {
  EXPECT_DOUBLE_EQ(sample_distance(2.0, 0, 4, 0.0), 2.0);  // s_0 = s
  EXPECT_DOUBLE_EQ(sample_distance(2.0, 3, 4, 0.0), 0.5);  // s_{N−1} = s^F − Δs
  EXPECT_DOUBLE_EQ(sample_distance(2.0, 0, 1, 0.5), 1.0);
  EXPECT_DOUBLE_EQ(valid_path_length({0, 0, -3}, {0, 0, -1}, {0, 0, -1}), 2.0);
  EXPECT_DOUBLE_EQ(valid_path_length({0, 0, 1}, {0, 0, -1}, {0, 0, -1}), 0.0);
}

}  // namespace
}  // namespace pellucid
