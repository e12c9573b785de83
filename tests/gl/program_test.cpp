#include "gl/program.hpp"

#include <algorithm>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "gl/resources/resources.hpp"
#include "tests/gl/gl_fixture.hpp"

namespace pellucid::gl::test {
namespace {

constexpr const char* kShaderPath = "PELLUCID_SHADER_PATH";

/// Shader files that take the place of embedded ones.
class ShaderTree {
 public:
  void write(const std::string& name, const std::string& text) { folder_.write(name, text); }

 private:
  TemporaryFolder folder_;
  ScopedEnvironment path_{kShaderPath, folder_.path()};
};

ExpandedSource::Line line_of(const ExpandedSource& source, const std::string& text) {
  std::size_t at = 0, number = 0;
  while (at < source.text.size()) {
    const std::size_t end = source.text.find('\n', at);
    if (source.text.substr(at, end - at) == text) return source.lines.at(number);
    at = end + 1;
    ++number;
  }
  ADD_FAILURE() << "no line '" << text << "' in\n" << source.text;
  return {};
}

TEST(ExpandIncludes, ResolvesEachFileOnceAndMapsLinesBack) {
  ShaderTree tree;
  tree.write("t/a.glsl", "float a() { return 1.0; }\n");
  tree.write("t/b.glsl", "// b\n#include \"t/a.glsl\"\nfloat b() { return a(); }\n");
  tree.write("t/main.frag.glsl", "#include \"t/a.glsl\"\n  #  include   \"t/b.glsl\"  // again\nvoid main() {}\n");
  const ExpandedSource source = expand_includes("t/main.frag.glsl", {{"N", "4"}, {"FLAG", ""}});
  EXPECT_TRUE(source.text.starts_with("#version 450 core\n#define N 4\n#define FLAG \n")) << source.text;
  EXPECT_EQ(source.files, (std::vector<std::string>{"t/main.frag.glsl", "t/a.glsl", "t/b.glsl"}));
  EXPECT_EQ(source.text.find("float a()"), source.text.rfind("float a()"));

  const auto expect_at = [&](const std::string& text, const std::string& file, int line) {
    const ExpandedSource::Line from = line_of(source, text);
    EXPECT_EQ(source.files.at(static_cast<std::size_t>(from.file)), file) << text;
    EXPECT_EQ(from.line, line) << text;
  };
  expect_at("float a() { return 1.0; }", "t/a.glsl", 1);
  expect_at("float b() { return a(); }", "t/b.glsl", 3);
  expect_at("void main() {}", "t/main.frag.glsl", 3);
  EXPECT_EQ(line_of(source, "#define N 4").line, 0);
}

TEST(ExpandIncludes, EndsCycles) {
  ShaderTree tree;
  tree.write("t/a.glsl", "#include \"t/b.glsl\"\nconst int a = 1;\n");
  tree.write("t/b.glsl", "#include \"t/a.glsl\"\n#include \"t/b.glsl\"\nconst int b = 2;");
  const ExpandedSource source = expand_includes("t/a.glsl", {});
  EXPECT_EQ(source.files.size(), 2U);
  EXPECT_EQ(line_of(source, "const int a = 1;").line, 2);
  EXPECT_EQ(line_of(source, "const int b = 2;").line, 3);
}

TEST(ExpandIncludes, ReadsNoDirectivesFromComments) {
  ShaderTree tree;
  tree.write("t/a.glsl",
             "/* how to use it:\n#include \"t/nowhere.glsl\"\n*/ // #include \"t/nowhere.glsl\"\nint x;\r\n");
  EXPECT_EQ(line_of(expand_includes("t/a.glsl", {}), "int x;").line, 4);
}

TEST(ExpandIncludes, NamesFileAndLineOfABadInclude) {
  ShaderTree tree;
  tree.write("t/main.frag.glsl", "// one\n#include \"t/inner.glsl\"\n");
  tree.write("t/inner.glsl", "// one\n// two\n#include \"t/nowhere.glsl\"\n");
  const std::string missing = message_of<RuntimeError>([] { expand_includes("t/main.frag.glsl", {}); });
  EXPECT_TRUE(missing.starts_with("t/inner.glsl:3: ")) << missing;
  EXPECT_TRUE(contains(missing, "'t/nowhere.glsl'")) << missing;
  tree.write("t/inner.glsl", "#include <vector>\n");
  const std::string malformed = message_of<RuntimeError>([] { expand_includes("t/main.frag.glsl", {}); });
  EXPECT_TRUE(malformed.starts_with("t/inner.glsl:1: ")) << malformed;
  tree.write("t/inner.glsl", "\n#version 330\n");
  const std::string version = message_of<RuntimeError>([] { expand_includes("t/main.frag.glsl", {}); });
  EXPECT_TRUE(version.starts_with("t/inner.glsl:2: ")) << version;
  const std::string root = message_of<RuntimeError>([] { expand_includes("t/nothing.frag.glsl", {}); });
  EXPECT_TRUE(contains(root, "'t/nothing.frag.glsl'")) << root;
}

TEST(ExplainLog, UnderstandsEachDriversForm) {
  ShaderTree tree;
  tree.write("t/a.glsl", "float a() {\n  return oops;\n}\n");
  tree.write("t/main.frag.glsl", "\n#include \"t/a.glsl\"\nvoid main() {}\n");
  const ExpandedSource source = expand_includes("t/main.frag.glsl", {{"N", "x"}});
  // In the expanded text: version, define, blank, then a.glsl from line 4; `oops` stands in line 5.
  const std::string wanted = "t/a.glsl:2: ";
  for (const char* log : {"0:5(10): error: `oops' undeclared\n", "0(5) : error C1503: undefined variable \"oops\"\n",
                          "ERROR: 0:5: 'oops' : undeclared identifier\n"}) {
    const std::string text = explain_log(log, source);
    EXPECT_TRUE(text.starts_with(wanted)) << text;
    EXPECT_TRUE(contains(text, "error") && contains(text, "\n  return oops;")) << text;
  }
  EXPECT_TRUE(contains(explain_log("0:2(1): error: bad define\n", source), "#define N x"));
  EXPECT_EQ(explain_log("error: no place given\n", source), "error: no place given");
  EXPECT_EQ(explain_log("0:4711(1): error: beyond the end", source), "0:4711(1): error: beyond the end");
}

class ProgramTest : public GlTest {
 protected:
  static constexpr const char* kCompute = "layout(local_size_x = 1) in;\n";
};

TEST_F(ProgramTest, ShowsFileLineAndSourceOfACompileError) {
  ShaderTree tree;
  tree.write("t/inner.glsl", "float twice(float x) {\n  return 2.0 * y;\n}\n");
  tree.write("t/main.comp.glsl", std::string(kCompute) + "#include \"t/inner.glsl\"\nvoid main() {}\n");
  const std::string message = message_of<RuntimeError>([] {
    const Program bad("bad", {"t/main.comp.glsl"}, {{"A", "1"}});
  });
  EXPECT_TRUE(message.starts_with("t/inner.glsl:2: ")) << message;
  EXPECT_TRUE(contains(message, "\n  return 2.0 * y;")) << message;
}

TEST_F(ProgramTest, ShowsLinkErrors) {
  ShaderTree tree;
  tree.write("t/main.vert.glsl", "out vec3 normal;\nvoid main() { normal = vec3(0.0); gl_Position = vec4(0.0); }\n");
  tree.write("t/main.frag.glsl", "in vec4 normal;\nout vec4 color;\nvoid main() { color = normal; }\n");
  const std::string message = message_of<RuntimeError>([] {
    const Program bad("mismatch", {"t/main.vert.glsl", "t/main.frag.glsl"});
  });
  EXPECT_TRUE(contains(message, "'mismatch'") && contains(message, "t/main.frag.glsl")) << message;
  EXPECT_TRUE(contains(message, "normal")) << message;
}

TEST_F(ProgramTest, RefusesAnUnknownKindOfStage) {
  ShaderTree tree;
  tree.write("t/main.glsl", "void main() {}\n");
  EXPECT_TRUE(contains(message_of<RuntimeError>([] { const Program bad("bad", {"t/main.glsl"}); }), ".frag.glsl"));
}

// The floats that a compute shader writes into a storage buffer of `count`.
std::vector<float> run(const Program& program, std::size_t count) {
  const Buffer buffer("results", count * sizeof(float));
  program.use();
  buffer.bind_storage(0);
  glDispatchCompute(1, 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  check("dispatch", "test");
  std::vector<float> values(count);
  std::memcpy(values.data(), buffer.read().data(), count * sizeof(float));
  return values;
}

TEST_F(ProgramTest, SetsUniformsOfEveryType) {
  const Program program("uniforms", {"tests/gl/uniforms.comp.glsl"});
  program.set("a_bool", true);
  program.set("an_int", -3);
  program.set("a_float", 2.5F);
  program.set("a_vec2", glm::vec2(1, 2));
  program.set("a_vec3", glm::vec3(3, 4, 5));
  program.set("a_vec4", glm::vec4(6, 7, 8, 9));
  program.set("an_ivec2", glm::ivec2(-10, 11));
  program.set("an_ivec3", glm::ivec3(12, -13, 14));
  glm::mat3 three(0.0F);
  three[2][0] = 15;  // column 2, row 0
  program.set("a_mat3", three);
  glm::mat4 four(0.0F);
  four[3][1] = 16;
  program.set("a_mat4", four);
  EXPECT_EQ(run(program, 19),
            (std::vector<float>{1, -3, 2.5F, 1, 2, 3, 4, 5, 6, 7, 8, 9, -10, 11, 12, -13, 14, 15, 16}));
  program.set("a_bool", false);
  EXPECT_EQ(run(program, 19)[0], 0.0F);
  EXPECT_NO_THROW(program.set("unheard_of", 1.0F));
}

TEST_F(ProgramTest, AWrongUniformTypeNamesUniformAndProgram) {
  const Program program("uniforms", {"tests/gl/uniforms.comp.glsl"});
  const std::string message = message_of<RuntimeError>([&] { program.set("a_vec3", 1.0F); });
  EXPECT_TRUE(contains(message, "'a_vec3'") && contains(message, "'uniforms'")) << message;
}

TEST_F(ProgramTest, CompilesDefinesIn) {
  ShaderTree tree;
  const std::string body = "layout(std430, binding = 0) buffer R { float r; };\nvoid main() { r = float(VALUE); }\n";
  tree.write("t/main.comp.glsl", kCompute + body);
  EXPECT_EQ(run(Program("define", {"t/main.comp.glsl"}, {{"VALUE", "3 * 4"}}), 1)[0], 12.0F);
}

TEST_F(ProgramTest, ReloadKeepsTheLastProgramThatWorks) {
  ShaderTree tree;
  const auto write = [&](const std::string& value) {
    tree.write("t/main.comp.glsl", std::string(kCompute) + "layout(std430, binding = 0) buffer R { float r; };\n" +
                                       "uniform float unused;\nvoid main() {\n  r = " + value + ";\n}\n");
  };
  write("1.0");
  Program program("edited", {"t/main.comp.glsl"});
  EXPECT_EQ(run(program, 1)[0], 1.0F);
  const GLuint first = program.id();

  write("wrong");
  const std::string log = program.reload();
  EXPECT_TRUE(log.starts_with("t/main.comp.glsl:5: ")) << log;
  EXPECT_EQ(program.id(), first);
  EXPECT_EQ(run(program, 1)[0], 1.0F);

  write("2.0");
  EXPECT_EQ(program.reload(), "");
  EXPECT_EQ(run(program, 1)[0], 2.0F);
}

TEST_F(ProgramTest, ReloadLeavesAProgramWhoseSourcesAreTheSame) {
  ShaderTree tree;
  const std::string head = std::string(kCompute) + "layout(std430, binding = 0) buffer R { float r; };\n";
  tree.write("t/shared.glsl", "const float wanted = 1.0;\n");
  tree.write("t/main.comp.glsl", head + "#include \"t/shared.glsl\"\nvoid main() { r = wanted; }\n");
  Program program("edited", {"t/main.comp.glsl"});
  const GLuint first = program.id();
  tree.write("t/other.glsl", "const float other = 1.0;\n");
  EXPECT_EQ(program.reload(), "");
  EXPECT_EQ(program.id(), first) << "it was compiled again for nothing";
  tree.write("t/shared.glsl", "const float wanted = 2.0;\n");
  EXPECT_EQ(program.reload(), "");
  EXPECT_NE(program.id(), first) << "what it includes has changed";
  EXPECT_EQ(run(program, 1)[0], 2.0F);
}

TEST_F(ProgramTest, GeneratedTextStandsBehindTheLastStage) {
  ShaderTree tree;
  tree.write("t/main.comp.glsl", std::string(kCompute) + "layout(std430, binding = 0) buffer R { float r; };\n" +
                                     "float wanted();\nvoid main() { r = wanted(); }\n");
  Program program("half of it", {"t/main.comp.glsl"}, {}, "float wanted() { return 7.0; }\n");
  EXPECT_EQ(run(program, 1)[0], 7.0F);
  const std::string message = message_of<RuntimeError>(
      [] { const Program wrong("half of it", {"t/main.comp.glsl"}, {}, "\nfloat wanted( {\n"); });
  EXPECT_TRUE(message.starts_with("generated text:2: ")) << message;
}

TEST_F(ProgramTest, ReloadFindsUniformsAgain) {
  ShaderTree tree;
  const auto write = [&](const std::string& uniforms) {
    tree.write("t/main.comp.glsl", std::string(kCompute) + "layout(std430, binding = 0) buffer R { float r; };\n" +
                                       uniforms + "void main() { r = wanted; }\n");
  };
  write("layout(location = 0) uniform float wanted;\n");
  Program program("edited", {"t/main.comp.glsl"});
  program.set("wanted", 3.0F);
  EXPECT_EQ(run(program, 1)[0], 3.0F);
  write("layout(location = 5) uniform float wanted;\n");
  ASSERT_EQ(program.reload(), "");
  program.set("wanted", 4.0F);
  EXPECT_EQ(run(program, 1)[0], 4.0F);
}

TEST_F(ProgramTest, AMovedFromProgramIsEmpty) {
  Program first("uniforms", {"tests/gl/uniforms.comp.glsl"});
  const GLuint id = first.id();
  const Program second = std::move(first);
  EXPECT_EQ(second.id(), id);
  EXPECT_FALSE(first);  // NOLINT(bugprone-use-after-move): moved-from means empty
  EXPECT_EQ(run(second, 19)[1], 0.0F);
}

TEST(Resources, OverrideOnDiskComesBeforeTheEmbeddedText) {
  const auto embedded = find_resource("tests/gl/uniforms.comp.glsl");
  ASSERT_TRUE(embedded.has_value());
  ShaderTree tree;
  EXPECT_EQ(find_resource("tests/gl/uniforms.comp.glsl"), embedded);
  tree.write("tests/gl/uniforms.comp.glsl", "edited");
  EXPECT_EQ(find_resource("tests/gl/uniforms.comp.glsl"), "edited");
  EXPECT_EQ(find_resource("tests/gl/nothing.glsl"), std::nullopt);
}

TEST(Resources, ListsByPrefixAndSuffix) {
  const std::vector<std::string> names = list_resources("tests/gl/", ".comp.glsl");
  EXPECT_NE(std::find(names.begin(), names.end(), "tests/gl/uniforms.comp.glsl"), names.end());
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  for (const std::string& name : names)
    EXPECT_TRUE(name.starts_with("tests/gl/") && name.ends_with(".comp.glsl"));
}

}  // namespace
}  // namespace pellucid::gl::test
