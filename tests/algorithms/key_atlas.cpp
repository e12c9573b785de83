// Key maps as shaders look them up, against a seamless cube map with linear interpolation between its levels.
#include "algorithms/key_maps/key_atlas.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <glm/gtc/packing.hpp>
#include <gtest/gtest.h>

#include "algorithms/geocube/cube_grid.hpp"
#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"
#include "tests/algorithms/compute.hpp"

namespace pellucid::scattering {
namespace {

constexpr int kSize = 16, kMaps = 5;  // the last has one texel a face

/// Noise, so that a fetch from a neighbouring texel, face or level is told.
KeyChain noise_chain() {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  KeyChain chain;
  for (int map = 0; map < kMaps; ++map) {
    auto& half = chain.half_rgb.emplace_back(18 * static_cast<std::size_t>((kSize >> map) * (kSize >> map)));
    for (std::uint16_t& value : half)
      value = glm::packHalf1x16(unit(random));
  }
  return chain;
}

float looked_up(const KeyChain& chain, const glm::vec3& direction, float level, int channel) {
  float sum = 0;
  for (int map = 0; map < kMaps; ++map) {
    const float share = std::max(1 - std::abs(level - static_cast<float>(map + 1)), 0.0F);
    const auto at = geocube::CubeGrid(kSize >> map).sample(glm::dvec3(direction));
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t value = 3 * at.index[k] + static_cast<std::size_t>(channel);
      sum += share * static_cast<float>(at.weight[k]) *
             glm::unpackHalf1x16(chain.half_rgb[static_cast<std::size_t>(map)][value]);
    }
  }
  return sum;
}

struct Input {
  glm::vec4 direction, level;
};

// Any directions, and such as meet the cube near an edge or a corner.
std::vector<Input> lookups(bool coloured) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> side(-1.0F, 1.0F), level(0.0F, static_cast<float>(kMaps));
  std::vector<Input> all;
  for (int i = 0; i < 4096; ++i) {
    Input q{};
    for (int c = 0; c < 3; ++c) {
      q.direction[c] = side(random);
      if (i % 2 == 1 && c != i % 3)
        q.direction[c] = std::copysign(1 - 0.05F * std::abs(q.direction[c]), q.direction[c]);
      q.level[c] = coloured || c == 0 ? level(random) : q.level[0];
    }
    all.push_back(q);
  }
  return all;
}

TEST(KeyAtlas, IsLookedUpAsASeamlessCubeMap) {
  const gl::Context context;
  const KeyChain chain = noise_chain();
  const KeyAtlas atlas = key_atlas(chain);
  gl::Texture texture = gl::Texture::make_2d("atlas", gl::Format::rgba16f, atlas.width, atlas.height);
  texture.upload_halves(atlas.half_rgba);
  texture.set_sampling(gl::Filter::linear, gl::Wrap::clamp);
  texture.bind(11);
  for (const bool coloured : {false, true}) {
    gl::Defines defines;
    if (coloured) defines.emplace_back("COLOURED_MEDIUM", "1");
    const gl::Program program("key maps", {"tests/algorithms/key_maps.comp.glsl"}, defines);
    program.set("key_map_size", atlas.map_size);
    program.set("key_face_rows", atlas.face_rows);
    program.set("key_scale", 2.0F);
    const std::vector<Input> in = lookups(coloured);
    const auto out = test::compute<glm::vec4>(program, in);
    for (std::size_t i = 0; i < in.size(); ++i) {
      for (int c = 0; c < 3; ++c) {
        const float expected = 2 * looked_up(chain, glm::vec3(in[i].direction), in[i].level[c], c);
        // Devices may take a fetch's weights in 256 steps; two fetches are summed.
        ASSERT_NEAR(out[i][c], expected, 0.02F) << coloured << ' ' << i << ' ' << c << " level " << in[i].level[c];
      }
    }
  }
}

}  // namespace
}  // namespace pellucid::scattering
