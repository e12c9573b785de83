#include "gl/cube_faces.hpp"

#include <algorithm>
#include <cstddef>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "gl/program.hpp"

namespace pellucid::gl {
namespace {

glm::dvec3 random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dvec3{normal(random), normal(random), normal(random)});
}

TEST(CubeFaces, DirectionAndTexelAreInverse) {
  std::mt19937 random(3);
  for (int i = 0; i < 500; ++i) {
    const glm::dvec3 direction = random_direction(random);
    const CubeTexel texel = cube_texel(direction);
    EXPECT_GE(std::min(texel.s, texel.t), 0.0);
    EXPECT_LE(std::max(texel.s, texel.t), 1.0);
    EXPECT_LT(glm::distance(glm::normalize(cube_direction(texel)), direction), 1e-12);
  }
}

TEST(CubeFaces, TheDeviceReadsTheSameTexel) {
  const Context context;
  constexpr int kSize = 8;
  Texture cube = Texture::make_cube("numbered cube", Format::r32f, kSize);
  std::vector<float> numbers(6 * kSize * kSize);
  for (std::size_t i = 0; i < numbers.size(); ++i)
    numbers[i] = static_cast<float>(i);
  cube.upload(numbers);
  std::mt19937 random(4);
  std::vector<glm::vec4> directions;
  for (int i = 0; i < 512; ++i)
    directions.emplace_back(glm::vec3(random_direction(random)), 0.0F);
  const Program program("cube texels", {"tests/gl/cube_texels.comp.glsl"});
  const Buffer in("directions", std::span<const glm::vec4>(directions));
  const Buffer out("texels", directions.size() * sizeof(float));
  in.bind_storage(0);
  out.bind_storage(1);
  cube.bind(0);
  program.use();
  glDispatchCompute(static_cast<GLuint>(directions.size() / 64), 1, 1);
  glMemoryBarrier(GL_ALL_BARRIER_BITS);
  const auto bytes = out.read();
  const auto* read = reinterpret_cast<const float*>(bytes.data());
  int differ = 0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const CubeTexel texel = cube_texel(glm::vec3(directions[i]));
    const auto column = std::min(static_cast<int>(texel.s * kSize), kSize - 1);
    const auto row = std::min(static_cast<int>(texel.t * kSize), kSize - 1);
    if (static_cast<float>((texel.face * kSize + row) * kSize + column) != read[i]) ++differ;
  }
  EXPECT_LE(differ, 2);  // on the border between two texels rounding decides
}

// A point that is drawn with the face's transform must be found where the cube map is read.
TEST(CubeFaces, TransformsPutAPointOnItsTexel) {
  std::mt19937 random(5);
  const glm::vec3 center(0.3F, -2, 5);
  for (int i = 0; i < 500; ++i) {
    const glm::dvec3 direction = random_direction(random);
    const double distance = 0.5 + i * 0.01;
    const CubeTexel texel = cube_texel(direction);
    const glm::vec4 clip =
        cube_face_to_clip(texel.face, center, 0.1F, 10.0F) * glm::vec4(center + glm::vec3(distance * direction), 1.0F);
    ASSERT_GT(clip.w, 0.0F);
    EXPECT_NEAR(clip.x / clip.w, 2 * texel.s - 1, 1e-4);
    EXPECT_NEAR(clip.y / clip.w, 2 * texel.t - 1, 1e-4);
    EXPECT_EQ(clip.z > -clip.w, clip.w > 0.1F);
    EXPECT_EQ(clip.z < clip.w, clip.w < 10.0F);
  }
}

}  // namespace
}  // namespace pellucid::gl
