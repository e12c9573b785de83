#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>

#include <epoxy/gl.h>
#include <fmt/format.h>

#include "gl/context.hpp"
#include "gl/current_context.hpp"
#include "gl/error.hpp"

namespace pellucid::gl {

namespace {

// A fixed buffer, since the callback runs inside the C driver and must not throw, not even std::bad_alloc.
struct PendingErrors {
  int count = 0;
  std::array<char, 512> first{};
};

struct CurrentContext {
  bool active = false;
  bool debug = false;  // the driver promises to report every error through the callback
  bool software = false;
  Limits limits;
};

// GL's current context is per thread, and so is synchronous debug output.
thread_local CurrentContext current_context;
thread_local PendingErrors pending;
std::atomic<std::ptrdiff_t> live_bytes{0};

void record(const char* message, std::size_t length) noexcept {
  if (pending.count++ > 0) return;  // the first error is the cause, the rest tend to follow from it
  while (length > 0 && (message[length - 1] == '\n' || message[length - 1] == ' '))
    --length;
  length = std::min(length, pending.first.size() - 1);
  std::memcpy(pending.first.data(), message, length);
  pending.first.at(length) = '\0';
}

void GLAPIENTRY on_debug_message(GLenum source, GLenum type, GLuint, GLenum, GLsizei length, const GLchar* message,
                                 const void*) noexcept {
  // Shader compilers' errors come with the info log, which program.cpp reports with file and line.
  if (type != GL_DEBUG_TYPE_ERROR || source == GL_DEBUG_SOURCE_SHADER_COMPILER) return;
  record(message, length < 0 ? std::strlen(message) : static_cast<std::size_t>(length));
}

const char* error_name(GLenum error) {
  switch (error) {
    case GL_INVALID_ENUM:
      return "GL_INVALID_ENUM";
    case GL_INVALID_VALUE:
      return "GL_INVALID_VALUE";
    case GL_INVALID_OPERATION:
      return "GL_INVALID_OPERATION";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
      return "GL_INVALID_FRAMEBUFFER_OPERATION";
    case GL_OUT_OF_MEMORY:
      return "GL_OUT_OF_MEMORY";
    default:
      return "unknown GL error";
  }
}

int integer(GLenum name) {
  GLint value = 0;
  glGetIntegerv(name, &value);
  return value;
}

std::size_t byte_limit(GLenum name) {
  GLint64 value = 0;
  glGetInteger64v(name, &value);
  return static_cast<std::size_t>(value);
}

}  // namespace

namespace detail {

Device describe_current() {
  const auto text = [](GLenum name) {
    const auto* value = reinterpret_cast<const char*>(glGetString(name));
    return std::string(value != nullptr ? value : "");
  };
  return {.index = -1,
          .platform = {},
          .vendor = text(GL_VENDOR),
          .renderer = text(GL_RENDERER),
          .version = text(GL_VERSION)};
}

void set_current(const Limits& limits, bool debug, bool software) {
  current_context = {.active = true, .debug = debug, .software = software, .limits = limits};
  drop_errors();
}

void clear_current() {
  current_context = {};
  pending.count = 0;
}

bool has_current() {
  return current_context.active;
}

bool is_software(const std::string& renderer) {
  for (const char* rasteriser : {"llvmpipe", "softpipe", "swrast", "Software Rasterizer", "SwiftShader", "OpenSWR"})
    if (renderer.find(rasteriser) != std::string::npos) return true;
  return false;
}

bool has_errors() {
  if (!current_context.debug && current_context.active) {
    while (const GLenum error = glGetError())
      record(error_name(error), std::strlen(error_name(error)));
  }
  return pending.count > 0;
}

void drop_errors() {
  // glGetError keeps its own flags beside the callback; they would surface in whoever asks next.
  for (int i = 0; i < 16 && current_context.active && glGetError() != GL_NO_ERROR; ++i)
    continue;
  pending.count = 0;
}

}  // namespace detail

Limits adopt_current_context(bool debug) {
  Limits limits;
  limits.max_texture_size = integer(GL_MAX_TEXTURE_SIZE);
  limits.max_3d_texture_size = integer(GL_MAX_3D_TEXTURE_SIZE);
  limits.max_cube_size = integer(GL_MAX_CUBE_MAP_TEXTURE_SIZE);
  limits.max_array_layers = integer(GL_MAX_ARRAY_TEXTURE_LAYERS);
  limits.max_ssbo_bytes = byte_limit(GL_MAX_SHADER_STORAGE_BLOCK_SIZE);
  limits.max_ubo_bytes = byte_limit(GL_MAX_UNIFORM_BLOCK_SIZE);

  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);  // core profiles start without it
  if (debug) {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(on_debug_message, nullptr);
    // Low severity is switched off by default although some drivers report errors with it.
    glDebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DONT_CARE, 0, nullptr, GL_FALSE);
    glDebugMessageControl(GL_DONT_CARE, GL_DEBUG_TYPE_ERROR, GL_DONT_CARE, 0, nullptr, GL_TRUE);
  } else {
    glDisable(GL_DEBUG_OUTPUT);
    glDebugMessageCallback(nullptr, nullptr);
  }
  // Only a debug context must send messages; in any other, glGetError is asked as well.
  const bool promised = debug && (integer(GL_CONTEXT_FLAGS) & GL_CONTEXT_FLAG_DEBUG_BIT) != 0;
  detail::set_current(limits, promised, detail::is_software(detail::describe_current().renderer));
  return limits;
}

const Limits& limits() {
  assert(current_context.active && "a GL context must be current");
  return current_context.limits;
}

bool software_renderer() {
  assert(current_context.active && "a GL context must be current");
  return current_context.software;
}

void check(std::string_view operation, std::string_view label) {
  if (!detail::has_errors()) return;
  std::string text = fmt::format("{} on '{}': {}", operation, label, pending.first.data());
  if (pending.count > 1) text += fmt::format(" (and {} more)", pending.count - 1);
  detail::drop_errors();
  throw RuntimeError(text);
}

std::size_t allocated_bytes() {
  return static_cast<std::size_t>(live_bytes.load(std::memory_order_relaxed));
}

void account_bytes(std::ptrdiff_t delta) {
  [[maybe_unused]] const std::ptrdiff_t before = live_bytes.fetch_add(delta, std::memory_order_relaxed);
  assert(before + delta >= 0 && "bytes freed that were never counted");
}

}  // namespace pellucid::gl
