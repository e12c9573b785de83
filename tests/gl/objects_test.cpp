#include "gl/objects.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "gl/program.hpp"
#include "tests/gl/gl_fixture.hpp"

namespace pellucid::gl::test {
namespace {

template <class T>
constexpr bool kMovesLikeAValue = std::is_nothrow_move_constructible_v<T>&& std::is_nothrow_move_assignable_v<T>&&
                                      std::is_nothrow_default_constructible_v<T> &&
                                  !std::is_copy_constructible_v<T> && !std::is_copy_assignable_v<T>;
static_assert(kMovesLikeAValue<Texture> && kMovesLikeAValue<Framebuffer> && kMovesLikeAValue<Buffer> &&
              kMovesLikeAValue<VertexArray> && kMovesLikeAValue<Program>);

using FramebufferTest = GlTest;
using BufferTest = GlTest;
using VertexArrayTest = GlTest;

TEST_F(FramebufferTest, ClearsItsAttachments) {
  const Texture half = Texture::make_2d("half", Format::rgba16f, 3, 2);
  const Texture number = Texture::make_2d("number", Format::r32ui, 3, 2);
  const Texture depth = Texture::make_2d("depth", Format::depth32f, 3, 2);
  const Framebuffer framebuffer("both", {&half, &number}, &depth);
  EXPECT_EQ(framebuffer.width(), 3);
  EXPECT_EQ(framebuffer.height(), 2);
  framebuffer.clear_color(0, {0.5F, -2.0F, 1024.0F, 1.0F});
  framebuffer.clear_color(1, {70000.0F, 0, 0, 0});
  framebuffer.clear_depth(0.25F);
  const std::vector<float> color = half.read();
  for (std::size_t i = 0; i < color.size(); i += 4) {
    EXPECT_EQ(color[i], 0.5F);
    EXPECT_EQ(color[i + 1], -2.0F);
    EXPECT_EQ(color[i + 2], 1024.0F);
  }
  for (const float bits : number.read())
    EXPECT_EQ(std::bit_cast<std::uint32_t>(bits), 70000U);
  for (const float z : depth.read())
    EXPECT_EQ(z, 0.25F);
}

TEST_F(FramebufferTest, BindingSetsTheViewport) {
  const Texture color = Texture::make_2d("color", Format::rgba8, 7, 5);
  const Framebuffer framebuffer("view", {&color});
  framebuffer.bind();
  GLint viewport[4] = {};
  glGetIntegerv(GL_VIEWPORT, viewport);
  EXPECT_EQ(viewport[2], 7);
  EXPECT_EQ(viewport[3], 5);
}

TEST_F(FramebufferTest, TakesDepthAlone) {
  const Texture depth = Texture::make_2d("shadow map", Format::depth32f, 4, 4);
  const Framebuffer framebuffer("shadow", {}, &depth);
  framebuffer.clear_depth(0.5F);
  EXPECT_EQ(depth.read(), std::vector<float>(16, 0.5F));
}

TEST_F(FramebufferTest, DrawsIntoOneFaceOrAll) {
  const Texture cube = Texture::make_cube("cube", Format::r32f, 2, 2);
  cube.clear({});
  Framebuffer::layered("face", cube, nullptr, 3).clear_color(0, {1, 0, 0, 0});
  std::vector<float> texels = cube.read();
  for (std::size_t i = 0; i < texels.size(); ++i)
    EXPECT_EQ(texels[i], i / 4 == 3 ? 1.0F : 0.0F) << i;
  const Framebuffer all = Framebuffer::layered("all faces", cube, nullptr, -1, 1);
  EXPECT_EQ(all.width(), 1);
  all.clear_color(0, {2, 0, 0, 0});
  EXPECT_EQ(cube.read(1), std::vector<float>(6, 2.0F));
}

TEST_F(FramebufferTest, DrawsSeveralColorsIntoOneLayer) {
  const Texture cube = Texture::make_cube("cube", Format::r32f, 2);
  const Texture other = Texture::make_cube("other cube", Format::rg32f, 2);
  const Texture depth = Texture::make_cube("cube depth", Format::depth32f, 2);
  cube.clear({});
  other.clear({});
  const Framebuffer face = Framebuffer::layered("two colours", {&cube, &other}, &depth, 4);
  face.clear_color(0, {1, 0, 0, 0});
  face.clear_color(1, {2, 3, 0, 0});
  face.clear_depth(0.25F);
  const std::vector<float> first = cube.read(), second = other.read(), depths = depth.read();
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i], i / 4 == 4 ? 1.0F : 0.0F) << i;
    EXPECT_EQ(second[2 * i + 1], i / 4 == 4 ? 3.0F : 0.0F) << i;
    if (i / 4 == 4) {
      EXPECT_EQ(depths[i], 0.25F) << i;
    }
  }
  const Texture small = Texture::make_cube("small cube", Format::r32f, 1);
  const std::string message = message_of<RuntimeError>([&] {
    Framebuffer::layered("bad layers", {&cube, &small}, nullptr, -1);
  });
  EXPECT_TRUE(contains(message, "'bad layers'") && contains(message, "'small cube'")) << message;
}

TEST_F(FramebufferTest, NamesWhatDoesNotFit) {
  const Texture color = Texture::make_2d("color", Format::rgba8, 4, 4);
  const Texture depth = Texture::make_2d("small depth", Format::depth32f, 2, 4);
  const std::string message = message_of<RuntimeError>([&] { const Framebuffer bad("bad", {&color}, &depth); });
  EXPECT_TRUE(contains(message, "'bad'") && contains(message, "'small depth'") && contains(message, "2x4")) << message;
  const std::string incomplete = message_of<RuntimeError>([&] { const Framebuffer bad("wrong kind", {&depth}); });
  EXPECT_TRUE(contains(incomplete, "'wrong kind'")) << incomplete;
}

TEST_F(FramebufferTest, AMovedFromFramebufferIsEmpty) {
  const Texture color = Texture::make_2d("color", Format::rgba8, 4, 2);
  Framebuffer first("mover", {&color});
  const GLuint id = first.id();
  const Framebuffer second = std::move(first);
  EXPECT_EQ(second.id(), id);
  EXPECT_EQ(first.id(), 0U);  // NOLINT(bugprone-use-after-move): moved-from means empty
  EXPECT_EQ(first.width() + first.height(), 0);
}

std::vector<int> ints(const Buffer& buffer) {
  const std::vector<std::byte> bytes = buffer.read();
  std::vector<int> values(bytes.size() / sizeof(int));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

TEST_F(BufferTest, KeepsWhatIsUploaded) {
  for (const int usage : {GL_STATIC_DRAW, GL_STREAM_DRAW}) {
    Buffer buffer("numbers", std::span<const int>(std::vector<int>{1, 2, 3, 4}), static_cast<GLenum>(usage));
    EXPECT_EQ(ints(buffer), (std::vector<int>{1, 2, 3, 4}));
    buffer.upload(std::span<const int>(std::vector<int>{9, 8}));  // the first bytes only
    EXPECT_EQ(ints(buffer), (std::vector<int>{9, 8, 3, 4}));
    buffer.upload(std::span<const int>(std::vector<int>{5, 6, 7, 8}));
    EXPECT_EQ(ints(buffer), (std::vector<int>{5, 6, 7, 8}));
  }
}

TEST_F(BufferTest, GrowsAndCountsItsBytes) {
  const std::size_t before = allocated_bytes();
  Buffer buffer("growing", 8);
  EXPECT_EQ(allocated_bytes() - before, 8U);
  buffer.upload(std::span<const int>(std::vector<int>(25, 3)));
  EXPECT_EQ(buffer.bytes(), 100U);
  EXPECT_EQ(allocated_bytes() - before, 100U);
  EXPECT_EQ(ints(buffer), std::vector<int>(25, 3));
}

TEST_F(BufferTest, AMovedFromBufferIsEmpty) {
  Buffer first("mover", 16);
  const GLuint id = first.id();
  Buffer second = std::move(first);
  EXPECT_EQ(second.id(), id);
  EXPECT_EQ(first.id(), 0U);  // NOLINT(bugprone-use-after-move): moved-from means empty
  EXPECT_EQ(first.bytes(), 0U);
  second = Buffer("other", 4);
  EXPECT_FALSE(glIsBuffer(id));
}

TEST_F(BufferTest, RefusesABlockThatIsTooLarge) {
  const Buffer buffer("wide", limits().max_ubo_bytes + 16);
  const std::string message = message_of<RuntimeError>([&] { buffer.bind_uniform(0); });
  EXPECT_TRUE(contains(message, "'wide'") && contains(message, std::to_string(limits().max_ubo_bytes))) << message;
}

TEST_F(BufferTest, AnErrorCarriesTheLabel) {
  const Buffer buffer("bound out of range", 16);
  const std::string message = message_of<RuntimeError>([&] { buffer.bind_uniform(100000); });
  EXPECT_TRUE(contains(message, "bind as uniform block on 'bound out of range': ")) << message;
}

TEST_F(BufferTest, RefusesMoreMemoryThanThereIs) {
  const std::size_t before = allocated_bytes();
  const std::string message = message_of<RuntimeError>([] { const Buffer buffer("endless", std::size_t{1} << 50); });
  EXPECT_TRUE(contains(message, "'endless'")) << message;
  EXPECT_THROW(Buffer("beyond GL", ~std::size_t{0}), RuntimeError);
  EXPECT_EQ(allocated_bytes(), before);
}

TEST_F(VertexArrayTest, DrawsIndexedInstances) {
  // A unit square from two triangles; each instance covers one column and has its own value.
  const std::vector<glm::vec3> corners = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<std::uint32_t> indices = {0, 1, 2, 0, 2, 3};
  const std::vector<glm::vec2> instances = {{0, 5}, {2, 7}};  // column, value
  const Buffer vertex_buffer("corners", std::span<const glm::vec3>(corners));
  const Buffer index_buffer("indices", std::span<const std::uint32_t>(indices));
  const Buffer instance_buffer("instances", std::span<const glm::vec2>(instances));
  VertexArray array("squares", vertex_buffer, sizeof(glm::vec3), {{.location = 0, .components = 3}}, &index_buffer);
  array.add_instanced(instance_buffer, sizeof(glm::vec2),
                      {{.location = 1, .components = 1}, {.location = 2, .components = 1, .offset = sizeof(float)}});
  const Program program("squares", {"tests/gl/instances.vert.glsl", "tests/gl/value.frag.glsl"});
  const Texture color = Texture::make_2d("columns", Format::r32f, 4, 2);
  const Framebuffer framebuffer("columns", {&color});
  framebuffer.clear_color(0, {});
  framebuffer.bind();
  program.use();
  array.bind();
  glDrawElementsInstanced(GL_TRIANGLES, 6, GL_UNSIGNED_INT, nullptr, 2);
  check("draw", "squares");
  EXPECT_EQ(color.read(), (std::vector<float>{5, 0, 7, 0, 5, 0, 7, 0}));
}

TEST_F(VertexArrayTest, AMovedFromVertexArrayIsEmpty) {
  VertexArray first("mover");
  const GLuint id = first.id();
  const VertexArray second = std::move(first);
  EXPECT_EQ(second.id(), id);
  EXPECT_EQ(first.id(), 0U);  // NOLINT(bugprone-use-after-move): moved-from means empty
}

}  // namespace
}  // namespace pellucid::gl::test
