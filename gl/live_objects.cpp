#include "gl/live_objects.hpp"

#include <array>

#include <epoxy/gl.h>
#include <fmt/format.h>

namespace pellucid::gl {
namespace {

// Drivers give small names, one after another; a gap as long as this has never been seen.
constexpr GLuint kGap = 2048;

std::string label_of(GLenum kind, GLuint name) {
  std::array<char, 128> text{};
  glGetObjectLabel(kind, name, static_cast<GLsizei>(text.size()), nullptr, text.data());
  return text.data();
}

// A program that is in use outlives its deletion, with Mesa even beyond the next glUseProgram.
bool deleted_program(GLuint name) {
  GLint deleted = GL_FALSE;
  glGetProgramiv(name, GL_DELETE_STATUS, &deleted);
  return deleted == GL_TRUE;
}

template <class Is>
void count(LiveObjects& out, const char* words, GLenum kind, Is is) {
  GLuint last = 0;
  for (GLuint name = 1; name <= last + kGap; ++name) {
    if (!is(name)) continue;
    ++out[fmt::format("{} '{}'", words, label_of(kind, name))];
    last = name;
  }
}

}  // namespace

LiveObjects count_live_objects() {
  LiveObjects out;
  count(out, "buffer", GL_BUFFER, [](GLuint name) { return glIsBuffer(name); });
  count(out, "framebuffer", GL_FRAMEBUFFER, [](GLuint name) { return glIsFramebuffer(name); });
  count(out, "program", GL_PROGRAM, [](GLuint name) { return glIsProgram(name) == GL_TRUE && !deleted_program(name); });
  count(out, "query", GL_QUERY, [](GLuint name) { return glIsQuery(name); });
  count(out, "renderbuffer", GL_RENDERBUFFER, [](GLuint name) { return glIsRenderbuffer(name); });
  count(out, "sampler", GL_SAMPLER, [](GLuint name) { return glIsSampler(name); });
  count(out, "shader", GL_SHADER, [](GLuint name) { return glIsShader(name); });
  count(out, "texture", GL_TEXTURE, [](GLuint name) { return glIsTexture(name); });
  count(out, "vertex array", GL_VERTEX_ARRAY, [](GLuint name) { return glIsVertexArray(name); });
  return out;
}

int total(const LiveObjects& objects) {
  int sum = 0;
  for (const auto& [words, number] : objects)
    sum += number;
  return sum;
}

std::string growth(const LiveObjects& before, const LiveObjects& after) {
  std::string words;
  for (const auto& [object, number] : after) {
    const auto known = before.find(object);
    const int more = number - (known == before.end() ? 0 : known->second);
    if (more > 0) words += fmt::format("{}{} × {}", words.empty() ? "" : ", ", more, object);
  }
  return words;
}

}  // namespace pellucid::gl
