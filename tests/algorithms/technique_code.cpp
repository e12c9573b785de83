// A row belongs to the code that made it: what changes a technique's hash, and what does not. The C++ side is tested by
// technique_code_test.cmake, on a tree of its own.
#include "algorithms/technique_code.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "algorithms/technique.hpp"
#include "gl/resources/resources.hpp"
#include "tests/temporary_folder.hpp"

namespace pellucid {
namespace {

std::map<std::string, std::string> hashes() {
  std::map<std::string, std::string> result;
  for (const TechniqueInfo& info : techniques())
    result.emplace(info.name, code_hash(info.name));
  return result;
}

/// The techniques whose hash changes with one comment more in the shader.
std::set<std::string> touched_by(const std::string& shader) {
  const test::TemporaryFolder folder;
  const auto before = hashes();
  std::filesystem::create_directories((folder / shader).parent_path());
  std::ofstream(folder / shader) << find_resource(shader).value() << "// edited\n";
  setenv("PELLUCID_SHADER_PATH", folder.path().c_str(), 1);
  const auto after = hashes();
  unsetenv("PELLUCID_SHADER_PATH");
  std::set<std::string> touched;
  for (const auto& [name, hash] : before)
    if (after.at(name) != hash) touched.insert(name);
  return touched;
}

TEST(TechniqueCode, DiffersFromTechniqueToTechnique) {
  const auto all = hashes();
  std::set<std::string> different;
  for (const auto& [name, hash] : all) {
    EXPECT_EQ(hash.size(), 64U) << name;
    different.insert(hash);
  }
  EXPECT_EQ(different.size(), all.size());
}

TEST(TechniqueCode, FollowsAnIncludedShader) {
  EXPECT_EQ(touched_by("algorithms/geocube/entry.glsl"), std::set<std::string>{"geocube"});
  EXPECT_EQ(touched_by("algorithms/shaders/integrate.glsl"), (std::set<std::string>{"ray_marching", "sampling_hulls"}));
  EXPECT_EQ(touched_by("algorithms/shaders/lighting.glsl").size(), techniques().size()) << "all draw opaque objects";
}

TEST(TechniqueCode, IgnoresShadersThatOnlyMeasure) {
  EXPECT_TRUE(touched_by("algorithms/geocube/bench/bare_glass.frag.glsl").empty());
  EXPECT_TRUE(touched_by("algorithms/sampling_hulls/bench/bare_front.frag.glsl").empty());
}

}  // namespace
}  // namespace pellucid
