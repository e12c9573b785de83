#include "gl/program.hpp"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <functional>

#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>

#include "gl/context.hpp"
#include "gl/current_context.hpp"
#include "gl/error.hpp"
#include "gl/label.hpp"
#include "gl/link.hpp"

namespace pellucid::gl {

namespace {

void delete_shader(GLuint id) {
  if (detail::has_current()) glDeleteShader(id);
}

struct StageKind {
  std::string_view ending;
  GLenum type;
  std::string_view log_heading;  // of this stage's part in NVIDIA's link log
};

constexpr StageKind kStages[] = {{".vert.glsl", GL_VERTEX_SHADER, "Vertex info"},
                                 {".frag.glsl", GL_FRAGMENT_SHADER, "Fragment info"},
                                 {".geom.glsl", GL_GEOMETRY_SHADER, "Geometry info"},
                                 {".comp.glsl", GL_COMPUTE_SHADER, "Compute info"}};

const StageKind& stage_kind(const Stage& stage) {
  for (const StageKind& kind : kStages)
    if (stage.ends_with(kind.ending)) return kind;
  throw RuntimeError(fmt::format(
      "'{}' is no shader stage: its name must end in .vert.glsl, .frag.glsl, .geom.glsl or .comp.glsl", stage));
}

std::string_view log_heading(GLenum type) {
  for (const StageKind& kind : kStages)
    if (kind.type == type) return kind.log_heading;
  return "unknown stage";
}

template <class Get>
std::string info_log(GLuint id, GLint length, Get get) {
  std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
  GLsizei written = 0;
  get(id, static_cast<GLsizei>(log.size()), &written, log.data());
  log.resize(static_cast<std::size_t>(written));
  return log;
}

Handle<delete_shader> compile(const StageSource& stage) {
  const GLuint id = glCreateShader(stage.type);
  Handle<delete_shader> shader(id);
  set_label(GL_SHADER, id, stage.source.files.front());
  const char* text = stage.source.text.c_str();
  const auto length = static_cast<GLint>(stage.source.text.size());
  glShaderSource(id, 1, &text, &length);
  glCompileShader(id);
  GLint compiled = GL_FALSE;
  glGetShaderiv(id, GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_FALSE) {
    GLint log_length = 0;
    glGetShaderiv(id, GL_INFO_LOG_LENGTH, &log_length);
    const std::string log = info_log(id, log_length, [](auto... args) { glGetShaderInfoLog(args...); });
    detail::drop_errors();
    throw RuntimeError(
        log.empty() ? fmt::format("{}: does not compile, and the driver says no more", stage.source.files.front())
                    : explain_log(log, stage.source));
  }
  return shader;
}

// A link log may have a part for each stage under a heading of its own.
std::string explain_link_log(const std::string& log, const std::vector<StageSource>& stages) {
  std::string out, part;
  const ExpandedSource* source = &stages.front().source;
  const auto flush = [&] {
    const std::string text = explain_log(part, *source);
    if (!out.empty() && !text.empty()) out += '\n';
    out += text;
    part.clear();
  };
  for (std::size_t at = 0; at < log.size();) {
    const std::size_t end = std::min(log.find('\n', at), log.size());
    const std::string_view line(log.data() + at, end - at);
    at = end + 1;
    const auto named = std::find_if(stages.begin(), stages.end(), [&](const StageSource& stage) {
      return line.starts_with(log_heading(stage.type));
    });
    if (named != stages.end()) {
      flush();
      source = &named->source;
    } else if (line.find_first_not_of("- \r\t") != std::string_view::npos) {
      part += line;
      part += '\n';
    }
  }
  flush();
  return out;
}

void append(ExpandedSource& source, const std::string& text) {
  if (text.empty()) return;
  const int file = static_cast<int>(source.files.size());
  source.files.emplace_back("generated text");
  int number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    source.text.append(text, at, end - at);
    source.text += '\n';
    source.lines.push_back({.file = file, .line = ++number});
    at = end + 1;
  }
}

std::vector<StageSource> sources_of(const std::vector<Stage>& names, const Defines& defines,
                                    const std::string& generated) {
  assert(!names.empty());
  std::vector<StageSource> stages;
  for (const Stage& name : names)
    stages.push_back({.type = stage_kind(name).type, .source = expand_includes(name, defines)});
  append(stages.back().source, generated);
  return stages;
}

std::size_t hash_of(const std::vector<StageSource>& stages) {
  std::string all;
  for (const StageSource& stage : stages)
    all += stage.source.text + '\0';
  return std::hash<std::string>{}(all);
}

}  // namespace

GLuint link_program(const std::string& label, const std::vector<StageSource>& stages) {
  assert(!stages.empty());
  std::vector<Handle<delete_shader>> shaders;
  for (const StageSource& stage : stages)
    shaders.push_back(compile(stage));
  Handle<delete_program> program(glCreateProgram());
  const GLuint id = program.id();
  set_label(GL_PROGRAM, id, label);
  for (const auto& shader : shaders)
    glAttachShader(id, shader.id());
  glLinkProgram(id);
  for (const auto& shader : shaders)
    glDetachShader(id, shader.id());
  GLint linked = GL_FALSE;
  glGetProgramiv(id, GL_LINK_STATUS, &linked);
  if (linked == GL_FALSE) {
    GLint log_length = 0;
    glGetProgramiv(id, GL_INFO_LOG_LENGTH, &log_length);
    const std::string log = info_log(id, log_length, [](auto... args) { glGetProgramInfoLog(args...); });
    detail::drop_errors();
    std::string names;
    for (const StageSource& stage : stages)
      names += (names.empty() ? "" : " + ") + stage.source.files.front();
    throw RuntimeError(fmt::format("'{}' does not link ({}): {}", label, names,
                                   log.empty() ? "the driver says no more" : explain_link_log(log, stages)));
  }
  check("link", label);
  return program.release();
}

void delete_program(GLuint id) {
  if (detail::has_current()) glDeleteProgram(id);
}

Program::Program(std::string label, std::vector<Stage> stages, Defines defines, std::string generated)
    : label_(std::move(label)),
      stages_(std::move(stages)),
      defines_(std::move(defines)),
      generated_(std::move(generated)) {
  const std::vector<StageSource> sources = sources_of(stages_, defines_, generated_);
  handle_ = Handle<delete_program>(link_program(label_, sources));
  built_from_ = hash_of(sources);
}

Program::~Program() = default;

Program::Program(Program&& other) noexcept {
  *this = std::move(other);
}

Program& Program::operator=(Program&& other) noexcept {
  if (this == &other) return *this;
  handle_ = std::move(other.handle_);
  label_ = std::exchange(other.label_, {});
  stages_ = std::exchange(other.stages_, {});
  defines_ = std::exchange(other.defines_, {});
  generated_ = std::exchange(other.generated_, {});
  built_from_ = std::exchange(other.built_from_, 0);
  locations_ = std::exchange(other.locations_, {});
  return *this;
}

void Program::use() const {
  assert(id() != 0);
  glUseProgram(id());
  check("use", label_);
}

std::string Program::reload() {
  assert(!stages_.empty() && "an empty program has no sources");
  try {
    const std::vector<StageSource> sources = sources_of(stages_, defines_, generated_);
    // Saving one file asks every program; most have not changed, and compiling them would hold up those that have.
    const std::size_t hash = hash_of(sources);
    if (hash == built_from_) return {};
    handle_ = Handle<delete_program>(link_program(label_, sources));
    built_from_ = hash;
    locations_.clear();
    return {};
  } catch (const RuntimeError& error) {
    return error.what();
  }
}

GLint Program::location(std::string_view name) const {
  assert(id() != 0);
  std::string key(name);
  if (const auto it = locations_.find(key); it != locations_.end()) return it->second;
  const GLint found = glGetUniformLocation(id(), key.c_str());
  locations_.emplace(std::move(key), found);
  return found;
}

void Program::check_set(std::string_view name) const {
  // A wrong type is the likely error; name the uniform, but only build the text when there is one.
  if (detail::has_errors()) check(fmt::format("set uniform '{}'", name), label_);
}

void Program::set(std::string_view name, bool value) const {
  set(name, value ? 1 : 0);
}

void Program::set(std::string_view name, int value) const {
  glProgramUniform1i(id(), location(name), value);
  check_set(name);
}

void Program::set(std::string_view name, float value) const {
  glProgramUniform1f(id(), location(name), value);
  check_set(name);
}

void Program::set(std::string_view name, const glm::vec2& value) const {
  glProgramUniform2fv(id(), location(name), 1, glm::value_ptr(value));
  check_set(name);
}

void Program::set(std::string_view name, const glm::vec3& value) const {
  glProgramUniform3fv(id(), location(name), 1, glm::value_ptr(value));
  check_set(name);
}

void Program::set(std::string_view name, const glm::vec4& value) const {
  glProgramUniform4fv(id(), location(name), 1, glm::value_ptr(value));
  check_set(name);
}

void Program::set(std::string_view name, const glm::ivec2& value) const {
  glProgramUniform2iv(id(), location(name), 1, glm::value_ptr(value));
  check_set(name);
}

void Program::set(std::string_view name, const glm::ivec3& value) const {
  glProgramUniform3iv(id(), location(name), 1, glm::value_ptr(value));
  check_set(name);
}

void Program::set(std::string_view name, const glm::mat3& value) const {
  glProgramUniformMatrix3fv(id(), location(name), 1, GL_FALSE, glm::value_ptr(value));
  check_set(name);
}

void Program::set(std::string_view name, const glm::mat4& value) const {
  glProgramUniformMatrix4fv(id(), location(name), 1, GL_FALSE, glm::value_ptr(value));
  check_set(name);
}

}  // namespace pellucid::gl
