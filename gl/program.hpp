#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <epoxy/gl.h>
#include <glm/glm.hpp>

#include "gl/objects.hpp"

namespace pellucid::gl {

void delete_program(GLuint);

/// One stage of a program: its kind follows from the name's ending, `.vert.glsl`, `.frag.glsl`, `.geom.glsl` or
/// `.comp.glsl`. The name is a resource (resources.hpp).
using Stage = std::string;
/// `#define NAME VALUE` lines that are put behind `#version`.
using Defines = std::vector<std::pair<std::string, std::string>>;

/// Resolves `#include "name"` (a resource name), each file at most once, and puts in `defines`. Files carry no
/// `#version`; `#version 450 core` is added here. The line tables map a line of `text` back to its file. Includes are
/// resolved before GLSL's own preprocessor runs, so one inside `#if` is always taken. Throws RuntimeError with
/// "file:line: " for an include that does not exist or is malformed.
struct ExpandedSource {
  std::string text;
  struct Line {
    int file = 0;  ///< index into `files`
    int line = 0;  ///< 1-based; 0 for a line added here (`#version`, defines)
  };
  std::vector<Line> lines;
  std::vector<std::string> files;
};
ExpandedSource expand_includes(std::string_view resource, const Defines& defines);

/// Rewrites a compiler's or linker's log, in Mesa's form `0:12(5): error: …`, NVIDIA's `0(12) : error C…: …` or
/// `ERROR: 0:12: …`, as "file:line: message" with the source line below it. Lines without a place are kept.
std::string explain_log(std::string_view log, const ExpandedSource& source);

/// A linked program. A compile or link error throws RuntimeError with "file:line: message" and the source line, with
/// includes resolved. `reload()` compiles from the current sources and keeps the last good program when that fails.
/// `generated` is text that no file holds, put behind the last stage's.
class Program {
 public:
  Program() = default;
  Program(std::string label, std::vector<Stage> stages, Defines defines = {}, std::string generated = {});

  void use() const;
  /// Compiles again where the sources are others than before; on failure keeps the program that works and returns the
  /// error's text, else an empty string.
  std::string reload();

  // Uniforms by name; a name that the linker removed is ignored, as GL does.
  void set(std::string_view name, bool) const;
  void set(std::string_view name, int) const;
  void set(std::string_view name, float) const;
  void set(std::string_view name, const glm::vec2&) const;
  void set(std::string_view name, const glm::vec3&) const;
  void set(std::string_view name, const glm::vec4&) const;
  void set(std::string_view name, const glm::ivec2&) const;
  void set(std::string_view name, const glm::ivec3&) const;
  void set(std::string_view name, const glm::mat3&) const;
  void set(std::string_view name, const glm::mat4&) const;
  GLuint id() const { return handle_.id(); }
  explicit operator bool() const { return id() != 0; }

  ~Program();
  Program(Program&&) noexcept;
  Program& operator=(Program&&) noexcept;

 private:
  GLint location(std::string_view name) const;
  void check_set(std::string_view name) const;
  Handle<delete_program> handle_;
  std::string label_;
  std::vector<Stage> stages_;
  Defines defines_;
  std::string generated_;
  std::size_t built_from_ = 0;  // a hash of the sources
  mutable std::unordered_map<std::string, GLint> locations_;
};

}  // namespace pellucid::gl
