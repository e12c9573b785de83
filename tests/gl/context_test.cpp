#include <cstddef>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <epoxy/gl.h>

#include "gl/objects.hpp"
#include "tests/gl/gl_fixture.hpp"

namespace pellucid::gl::test {
namespace {

static_assert(std::is_nothrow_move_constructible_v<Context> && std::is_nothrow_move_assignable_v<Context>);
static_assert(!std::is_copy_constructible_v<Context>);

using ContextTest = GlTest;

TEST_F(ContextTest, IsCoreProfileOfTheVersionWeTarget) {
  GLint major = 0, minor = 0, profile = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  glGetIntegerv(GL_MINOR_VERSION, &minor);
  glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
  EXPECT_GE(10 * major + minor, 45);
  EXPECT_EQ(profile, GL_CONTEXT_CORE_PROFILE_BIT);
  EXPECT_FALSE(context().device().renderer.empty());
  EXPECT_FALSE(context().device().version.empty());
}

TEST_F(ContextTest, ReadsTheLimitsOfTheDevice) {
  // The minima that OpenGL 4.5 promises.
  EXPECT_GE(limits().max_texture_size, 16384);
  EXPECT_GE(limits().max_3d_texture_size, 2048);
  EXPECT_GE(limits().max_cube_size, 16384);
  EXPECT_GE(limits().max_array_layers, 2048);
  EXPECT_GE(limits().max_ubo_bytes, 16384U);
  EXPECT_GE(limits().max_ssbo_bytes, std::size_t{1} << 27);
  EXPECT_EQ(context().limits().max_texture_size, limits().max_texture_size);
}

TEST_F(ContextTest, KnowsACpuRasteriserByItsName) {
  EXPECT_EQ(software_renderer(), context().software());
  EXPECT_EQ(context().software(), context().device().renderer.find("llvmpipe") != std::string::npos ||
                                      context().device().renderer.find("softpipe") != std::string::npos);
}

TEST_F(ContextTest, ListsDevicesThatWorkAndKeepsTheCurrentContext) {
  const Texture texture = Texture::make_2d("kept", Format::r8, 4, 4);
  const std::vector<Device> devices = list_devices();
  ASSERT_FALSE(devices.empty());
  for (const Device& device : devices) {
    EXPECT_FALSE(device.renderer.empty());
    EXPECT_FALSE(device.vendor.empty());
    EXPECT_EQ(device.platform, device.index < 0 ? "surfaceless" : "device");
  }
  EXPECT_TRUE(glIsTexture(texture.id()));
  EXPECT_EQ(texture.read().size(), 16U);
}

TEST_F(ContextTest, OpensEveryDeviceItLists) {
  for (const Device& device : list_devices()) {
    const Context opened({.device = device.index});
    EXPECT_EQ(opened.device().renderer, device.renderer);
    EXPECT_EQ(opened.device().index, device.index);
  }
}

TEST_F(ContextTest, RefusesADeviceThatDoesNotExistAndNamesThoseThatDo) {
  for (const int index : {4711, -2}) {
    const std::string message = message_of<InputError>([&] { const Context none({.device = index}); });
    EXPECT_TRUE(contains(message, std::to_string(index))) << message;
    EXPECT_TRUE(contains(message, list_devices().front().renderer)) << message;
  }
  EXPECT_EQ(Texture::make_2d("after", Format::r8, 2, 2).read().size(), 4U);  // ours is still current
}

TEST_F(ContextTest, NamesTheObjectAndTheOperationOfAnError) {
  glEnable(GL_TEXTURE_BUFFER_OFFSET_ALIGNMENT);  // not a capability
  const std::string message = message_of<RuntimeError>([] { check("switch on", "sky"); });
  EXPECT_TRUE(message.starts_with("switch on on 'sky': ")) << message;
  EXPECT_TRUE(contains(message, "INVALID_ENUM")) << message;
  EXPECT_NO_THROW(check("switch on", "sky"));  // reported once
}

TEST_F(ContextTest, CountsFurtherErrors) {
  for (int i = 0; i < 3; ++i)
    glEnable(GL_TEXTURE_BUFFER_OFFSET_ALIGNMENT);
  const std::string message = message_of<RuntimeError>([] { check("switch on", "sky"); });
  EXPECT_TRUE(contains(message, "and 2 more")) << message;
}

TEST(ContextLife, ReportsErrorsWithoutDebugOutputToo) {
  const Context context({.device = {}, .debug = false});
  glEnable(GL_TEXTURE_BUFFER_OFFSET_ALIGNMENT);
  const std::string message = message_of<RuntimeError>([] { check("switch on", "sky"); });
  EXPECT_TRUE(contains(message, "'sky': GL_INVALID_ENUM")) << message;
  EXPECT_NO_THROW(check("switch on", "sky"));
}

TEST(ContextLife, OneAfterTheOther) {
  for (int i = 0; i < 2; ++i) {
    const Context context;
    Texture texture = Texture::make_2d("of this context", Format::r32f, 2, 1);
    texture.upload(std::vector<float>{1.5F, -2.0F});
    EXPECT_EQ(texture.read(), (std::vector<float>{1.5F, -2.0F}));
  }
}

TEST(ContextLife, TwoOnOneDeviceDoNotEndEachOther) {
  Context first;
  Texture texture = Texture::make_2d("of the first", Format::r8, 2, 2);
  texture.clear({1, 1, 1, 1});
  {
    const Context second;
    EXPECT_EQ(Texture::make_2d("of the second", Format::r8, 3, 3).read().size(), 9U);
  }
  first.make_current();
  EXPECT_EQ(texture.read(), std::vector<float>(4, 1.0F));
}

TEST(ContextLife, AnObjectMayOutliveItsContext) {
  const std::size_t before = allocated_bytes();
  {
    std::optional<Context> context(std::in_place);
    const Texture texture = Texture::make_2d("survivor", Format::r8, 8, 8);
    const Buffer buffer("survivor", 64);
    const VertexArray array("survivor");
    context.reset();
    EXPECT_GT(allocated_bytes(), before);
  }
  EXPECT_EQ(allocated_bytes(), before);
}

TEST(ContextLife, AMovedContextStaysCurrent) {
  Context first;
  const std::string renderer = first.device().renderer;
  const Context second(std::move(first));
  EXPECT_EQ(second.device().renderer, renderer);
  EXPECT_EQ(first.device().renderer, "");  // NOLINT(bugprone-use-after-move): moved-from means empty
  EXPECT_EQ(first.limits().max_texture_size, 0);
  EXPECT_EQ(Texture::make_2d("after the move", Format::r8, 2, 2).read().size(), 4U);
}

TEST(ContextLife, AdoptsAContextThatSomebodyElseMadeCurrent) {
  const Context context({.device = {}, .debug = false});
  const Limits adopted = adopt_current_context(true);
  EXPECT_EQ(adopted.max_texture_size, context.limits().max_texture_size);
  glEnable(GL_TEXTURE_BUFFER_OFFSET_ALIGNMENT);
  EXPECT_THROW(check("switch on", "window"), RuntimeError);
  EXPECT_NO_THROW(check("switch on", "window"));
}

}  // namespace
}  // namespace pellucid::gl::test
