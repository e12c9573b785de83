#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <glm/gtc/packing.hpp>
#include <gtest/gtest.h>

#include "gl/objects.hpp"
#include "gl/program.hpp"
#include "tests/gl/gl_fixture.hpp"

namespace pellucid::gl::test {
namespace {

static_assert(std::is_nothrow_move_constructible_v<Texture> && std::is_nothrow_move_assignable_v<Texture>);
static_assert(!std::is_copy_constructible_v<Texture>);

using TextureTest = GlTest;

// Texels that `format` represents exactly.
std::vector<float> exact_texels(Format format, std::size_t count) {
  std::vector<float> texels(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto n = static_cast<float>(i);
    switch (format) {
      case Format::r8:
      case Format::rg8:
      case Format::rgba8:
        texels[i] = static_cast<float>((i * 37) % 256) / 255.0F;
        break;
      case Format::r16f:
      case Format::rg16f:
      case Format::rgba16f:
        texels[i] = (i % 2 == 0 ? 1.0F : -1.0F) * n * 0.25F;
        break;
      case Format::r32f:
      case Format::rg32f:
      case Format::rgba32f:
        texels[i] = (i % 2 == 0 ? 1.0F : -1.0F) * std::exp2(n - 20.0F) * 1.1F;
        break;
      case Format::r32ui:
        texels[i] = std::bit_cast<float>(static_cast<std::uint32_t>(i * 2654435761U));
        break;
      case Format::depth32f:
        texels[i] = n / static_cast<float>(count);
        break;
    }
  }
  return texels;
}

void expect_same(const std::vector<float>& got, const std::vector<float>& wanted, Format format) {
  ASSERT_EQ(got.size(), wanted.size());
  const bool eight_bits = texel_bytes(format) == static_cast<std::size_t>(channels(format));
  for (std::size_t i = 0; i < got.size(); ++i) {
    if (eight_bits)
      EXPECT_NEAR(got[i], wanted[i], 1e-6F) << name(format) << " value " << i;
    else
      EXPECT_EQ(std::bit_cast<std::uint32_t>(got[i]), std::bit_cast<std::uint32_t>(wanted[i]))
          << name(format) << " " << i;
  }
}

class FormatTest : public GlTest, public testing::WithParamInterface<Format> {};

TEST_P(FormatTest, RoundTrips2d) {
  const Format format = GetParam();
  // An odd width shows rows that are not tightly packed.
  Texture texture = Texture::make_2d("round trip", format, 5, 3);
  const std::vector<float> texels = exact_texels(format, 15 * static_cast<std::size_t>(channels(format)));
  texture.upload(texels);
  expect_same(texture.read(), texels, format);
  EXPECT_EQ(texture.bytes(), 15 * texel_bytes(format));
}

TEST_P(FormatTest, RoundTripsArrayLayerByLayer) {
  const Format format = GetParam();
  Texture texture = Texture::make_2d_array("layers", format, 3, 2, 4);
  const std::size_t layer_size = 6 * static_cast<std::size_t>(channels(format));
  const std::vector<float> texels = exact_texels(format, 4 * layer_size);
  for (int layer = 3; layer >= 0; --layer)
    texture.upload_layer(layer, std::span(texels).subspan(static_cast<std::size_t>(layer) * layer_size, layer_size));
  expect_same(texture.read(), texels, format);
}

TEST_P(FormatTest, ClearsEveryTexel) {
  const Format format = GetParam();
  const Texture texture = Texture::make_2d("cleared", format, 3, 3, 2);
  texture.clear({1.0F, 0.0F, 1.0F, 0.0F});
  for (int level = 0; level < 2; ++level) {
    const std::vector<float> texels = texture.read(level);
    ASSERT_FALSE(texels.empty());
    for (std::size_t i = 0; i < texels.size(); ++i) {
      const float wanted = i % static_cast<std::size_t>(channels(format)) % 2 == 0 ? 1.0F : 0.0F;
      const float got =
          format == Format::r32ui ? static_cast<float>(std::bit_cast<std::uint32_t>(texels[i])) : texels[i];
      EXPECT_EQ(got, wanted) << name(format) << " value " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, FormatTest,
                         testing::Values(Format::r8, Format::rg8, Format::rgba8, Format::r16f, Format::rg16f,
                                         Format::rgba16f, Format::r32f, Format::rg32f, Format::rgba32f, Format::r32ui,
                                         Format::depth32f),
                         [](const auto& instance) { return name(instance.param); });

// Fetched as halves and widened here; NaN is left out, since nothing promises its payload.
TEST_F(TextureTest, EveryHalfReadsBackAsItself) {
  std::vector<float> all;
  for (int sign = 0; sign < 2; ++sign) {
    for (int exponent = 0; exponent < 31; ++exponent)
      for (int mantissa = 0; mantissa < 1024; ++mantissa)
        all.push_back((sign == 0 ? 1.0F : -1.0F) *
                      std::ldexp(static_cast<float>(mantissa + (exponent > 0 ? 1024 : 0)), std::max(exponent, 1) - 25));
    all.push_back((sign == 0 ? 1.0F : -1.0F) * std::numeric_limits<float>::infinity());
  }
  all.resize((all.size() + 255) / 256 * 256, 0.5F);
  Texture texture = Texture::make_2d("halves", Format::rgba16f, 64, static_cast<int>(all.size() / 256));
  texture.upload(all);
  const std::vector<float> got = texture.read();
  for (std::size_t i = 0; i < all.size(); ++i)
    ASSERT_EQ(std::bit_cast<std::uint32_t>(got[i]), std::bit_cast<std::uint32_t>(all[i])) << all[i];
}

TEST_F(TextureTest, TakesHalvesAsTheyAre) {
  std::vector<std::uint16_t> halves(std::size_t{1} << 16);
  std::vector<float> values(halves.size());
  for (std::size_t i = 0; i < halves.size(); ++i) {
    const auto half = static_cast<std::uint16_t>(i);
    halves[i] = (half & 0x7c00U) == 0x7c00U ? std::uint16_t{0x3c00} : half;  // 1 in place of infinities and NaNs
    values[i] = glm::unpackHalf1x16(halves[i]);
  }
  Texture flat = Texture::make_2d("flat", Format::rgba16f, 128, 128),
          deep = Texture::make_3d("deep", Format::rg16f, 32, 32, 32);
  flat.upload_halves(halves);
  deep.upload_halves(halves);
  EXPECT_EQ(flat.read(), values);
  EXPECT_EQ(deep.read(), values);
}

TEST_F(TextureTest, RoundTrips3d) {
  Texture texture = Texture::make_3d("volume", Format::rg16f, 3, 4, 5);
  const std::vector<float> texels = exact_texels(Format::rg16f, 120);
  texture.upload(texels);
  expect_same(texture.read(), texels, Format::rg16f);
  EXPECT_EQ(texture.depth(), 5);
}

TEST_F(TextureTest, RoundTripsCubeByFaceAndAsAWhole) {
  Texture texture = Texture::make_cube("sky", Format::rgba32f, 2);
  const std::vector<float> texels = exact_texels(Format::rgba32f, 96);
  texture.upload(texels);
  expect_same(texture.read(), texels, Format::rgba32f);
  const std::vector<float> face(16, 7.0F);
  texture.upload_layer(4, face);
  std::vector<float> wanted = texels;
  std::copy(face.begin(), face.end(), wanted.begin() + 64);
  expect_same(texture.read(), wanted, Format::rgba32f);
  EXPECT_EQ(texture.depth(), 6);
}

TEST_F(TextureTest, UploadsAndReadsAMipmapLevel) {
  Texture texture = Texture::make_3d("levels", Format::r32f, 8, 4, 2, 3);
  const std::vector<float> level1 = exact_texels(Format::r32f, 8);
  texture.upload(level1, 1);
  expect_same(texture.read(1), level1, Format::r32f);
  EXPECT_EQ(texture.read(2).size(), 2U);
  EXPECT_EQ(texture.bytes(), (64U + 8U + 2U) * 4U);
}

TEST_F(TextureTest, MipmapsAreAverages) {
  Texture texture = Texture::make_2d("average", Format::r32f, 2, 2, 2);
  texture.upload(std::vector<float>{1, 2, 3, 6});
  texture.generate_mipmaps();
  EXPECT_FLOAT_EQ(texture.read(1).at(0), 3.0F);
}

float trilinear(const std::vector<float>& v, int n, float x, float y, float z) {
  const auto axis = [n](float u) {
    return std::clamp(u * static_cast<float>(n) - 0.5F, 0.0F, static_cast<float>(n - 1));
  };
  const float p[3] = {axis(x), axis(y), axis(z)};
  float sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    float weight = 1;
    int index[3];
    for (int a = 0; a < 3; ++a) {
      const int low = static_cast<int>(p[a]);
      const float f = p[a] - static_cast<float>(low);
      const bool high = (corner >> a & 1) != 0;
      index[a] = std::min(low + (high ? 1 : 0), n - 1);
      weight *= high ? f : 1 - f;
    }
    sum += weight * v[static_cast<std::size_t>((index[2] * n + index[1]) * n + index[0])];
  }
  return sum;
}

TEST_F(TextureTest, Interpolates3dTrilinearly) {
  constexpr int kSize = 4, kPoints = 64;
  std::vector<float> voxels(kSize * kSize * kSize);
  for (std::size_t i = 0; i < voxels.size(); ++i)
    voxels[i] = static_cast<float>((i * 29) % 64) / 63.0F;
  Texture volume = Texture::make_3d("volume", Format::r32f, kSize, kSize, kSize);
  volume.upload(voxels);
  volume.set_sampling(Filter::linear, Wrap::clamp);

  std::vector<glm::vec4> points(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) {
    const auto coordinate = [&](std::size_t k) { return static_cast<float>((i * k) % 97) / 90.0F - 0.03F; };
    points[i] = {coordinate(31), coordinate(47), coordinate(59), 0};
  }
  const Buffer buffer("points", std::span<const glm::vec4>(points));
  const Program program("sample 3D", {"tests/gl/sample_3d.comp.glsl"});
  program.use();
  volume.bind(0);
  buffer.bind_storage(0);
  glDispatchCompute(kPoints, 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  const std::vector<std::byte> bytes = buffer.read();
  for (std::size_t i = 0; i < kPoints; ++i) {
    glm::vec4 sampled;
    std::memcpy(&sampled, bytes.data() + i * sizeof(glm::vec4), sizeof sampled);
    const float wanted = trilinear(voxels, kSize, points[i].x, points[i].y, points[i].z);
    EXPECT_NEAR(sampled.w, wanted, 1.0F / 128.0F) << "point " << i;  // texture units weigh with 8 bits
  }
}

TEST_F(TextureTest, BorderIsTransparentBlackAndRepeatRepeats) {
  Texture texture = Texture::make_3d("wrap", Format::r32f, 2, 2, 2);
  texture.upload(std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8});
  const Program program("sample 3D", {"tests/gl/sample_3d.comp.glsl"});
  const auto sample = [&](glm::vec4 point) {
    const Buffer buffer("point", std::span<const glm::vec4>(&point, 1));
    program.use();
    texture.bind(0);
    buffer.bind_storage(0);
    glDispatchCompute(1, 1, 1);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glm::vec4 result;
    std::memcpy(&result, buffer.read().data(), sizeof result);
    return result.w;
  };
  const glm::vec4 outside{1.25F, 0.25F, 0.25F, 0};
  texture.set_sampling(Filter::nearest, Wrap::border);
  EXPECT_EQ(sample(outside), 0.0F);
  texture.set_sampling(Filter::nearest, Wrap::repeat);
  EXPECT_EQ(sample(outside), 1.0F);
  texture.set_sampling(Filter::nearest, Wrap::clamp);
  EXPECT_EQ(sample(outside), 2.0F);
}

TEST_F(TextureTest, RefusesWhatIsTooLargeBeforeAllocating) {
  const std::size_t before = allocated_bytes();
  const Limits& limit = limits();
  struct Case {
    std::string limit;
    std::function<void()> make;
  };
  const std::vector<Case> cases = {
      {std::to_string(limit.max_texture_size), [] { Texture::make_2d("huge", Format::r8, 100000, 100000); }},
      {std::to_string(limit.max_3d_texture_size),
       [&] { Texture::make_3d("huge", Format::r8, 1, 1, limit.max_3d_texture_size + 1); }},
      {std::to_string(limit.max_cube_size), [&] { Texture::make_cube("huge", Format::r8, limit.max_cube_size + 1); }},
      {std::to_string(limit.max_array_layers),
       [&] { Texture::make_2d_array("huge", Format::r8, 1, 1, limit.max_array_layers + 1); }},
      {"1 to 3", [] { Texture::make_2d("huge", Format::r8, 4, 4, 4); }},
      {"width 0", [] { Texture::make_2d("huge", Format::r8, 0, 4); }},
      {"height -1", [] { Texture::make_2d("huge", Format::r8, 4, -1); }},
  };
  for (const Case& c : cases) {
    const std::string message = message_of<RuntimeError>(c.make);
    EXPECT_TRUE(contains(message, "'huge'")) << message;
    EXPECT_TRUE(contains(message, c.limit)) << message;
  }
  EXPECT_EQ(allocated_bytes(), before);
}

TEST_F(TextureTest, AMovedFromTextureIsEmpty) {
  Texture first = Texture::make_2d("mover", Format::rgba16f, 4, 2);
  const GLuint id = first.id();
  Texture second(std::move(first));
  EXPECT_EQ(second.id(), id);
  EXPECT_EQ(second.label(), "mover");
  // NOLINTBEGIN(bugprone-use-after-move): moved-from means empty
  EXPECT_FALSE(first);
  EXPECT_EQ(first.id(), 0U);
  EXPECT_EQ(first.width() + first.height() + first.depth() + first.levels(), 0);
  EXPECT_EQ(first.bytes(), 0U);
  EXPECT_EQ(first.label(), "");
  // NOLINTEND(bugprone-use-after-move)
  Texture third = Texture::make_2d("replaced", Format::r8, 1, 1);
  const GLuint replaced = third.id();
  third = std::move(second);
  EXPECT_EQ(third.id(), id);
  EXPECT_FALSE(glIsTexture(replaced));
  EXPECT_EQ(third.bytes(), 64U);
}

TEST_F(TextureTest, CountsBytesWhileItLives) {
  const std::size_t before = allocated_bytes();
  {
    const Texture texture = Texture::make_cube("counted", Format::rgba16f, 4, 2);
    EXPECT_EQ(allocated_bytes() - before, 6U * (16U + 4U) * 8U);
  }
  EXPECT_EQ(allocated_bytes(), before);
}

TEST_F(TextureTest, AnErrorCarriesTheLabel) {
  const Texture texture = Texture::make_2d("not for images", Format::depth32f, 2, 2);
  const std::string message = message_of<RuntimeError>([&] { texture.bind_image(0, GL_READ_ONLY); });
  EXPECT_TRUE(contains(message, "'not for images': ")) << message;
}

TEST_F(TextureTest, GivesTheDriverItsLabel) {
  const Texture texture = Texture::make_2d("seen in a debugger", Format::r8, 2, 2);
  char label[64] = {};
  glGetObjectLabel(GL_TEXTURE, texture.id(), sizeof label, nullptr, label);
  EXPECT_STREQ(label, "seen in a debugger");
}

}  // namespace
}  // namespace pellucid::gl::test
