// GLSL functions against their C++ twins.
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "algorithms/opacity.hpp"
#include "algorithms/sampling_hulls/sampling_hulls.hpp"
#include "algorithms/valid_path.hpp"
#include "gl/context.hpp"
#include "gl/program.hpp"

namespace pellucid {
namespace {

struct Input {
  float extinction, interval, step, offset;
  glm::vec3 s;
  float count;
  glm::vec3 sf;
  float i;
  glm::vec3 ray;
  float opacity;
};
struct Output {
  float voxel, corrected, step, path, sample_at, pad[3];
};

std::vector<Output> run_on_gpu(const std::vector<Input>& inputs) {
  const gl::Program program("twins", {"tests/algorithms/opacity.comp.glsl"});
  const gl::Buffer in("inputs", std::span<const Input>(inputs));
  const gl::Buffer out("outputs", inputs.size() * sizeof(Output));
  in.bind_storage(0);
  out.bind_storage(1);
  program.use();
  glDispatchCompute(static_cast<GLuint>((inputs.size() + 63) / 64), 1, 1);
  glMemoryBarrier(GL_ALL_BARRIER_BITS);
  std::vector<Output> outputs(inputs.size());
  const auto bytes = out.read();
  std::memcpy(outputs.data(), bytes.data(), bytes.size());
  return outputs;
}

// Random media and paths, and with them every declared extreme of N and of the sample's place.
std::vector<Input> inputs() {
  const auto infos = parameter_table<sampling_hulls::Parameters>().infos();
  auto bound = [&](std::string_view name, bool high) {
    for (const auto& p : infos) {
      if (p.name == name) return static_cast<float>(high ? p.max : p.min);
    }
    throw std::logic_error("no such parameter");
  };
  std::mt19937 random(11);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  std::vector<Input> all;
  for (int k = 0; k < 4096; ++k) {
    Input q{};
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
    q.ray = glm::normalize(glm::vec3(unit(random), unit(random), unit(random)) - glm::vec3(0.5F));
    q.opacity = k % 13 == 0 ? 1.0F : k % 17 == 0 ? 0.0F : unit(random);
    all.push_back(q);
  }
  return all;
}

TEST(ShaderTwins, OpacityAndValidPath) {
  const gl::Context context;
  const std::vector<Input> in = inputs();
  const std::vector<Output> out = run_on_gpu(in);
  int clipped = 0;
  for (std::size_t k = 0; k < in.size(); ++k) {
    const Input& q = in[k];
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
  }
  EXPECT_GT(clipped, 1000) << "paths that rounding turned round must be among the inputs";
  EXPECT_LT(clipped, 3000);
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
