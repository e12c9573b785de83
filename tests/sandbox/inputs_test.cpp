// The program takes these inputs in, and its outputs keep what was computed.
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "tests/sandbox/pictures.hpp"
#include "tests/sandbox/program.hpp"

namespace pellucid::test {
namespace {

using nlohmann::json;

std::string name_of(const std::filesystem::path& path) {
  return path.string();
}

TEST(Inputs, NumbersOfTheCommandLineAreFinite) {
  const TemporaryFolder folder;
  const std::string scene = name_of(write_small_scene(folder)), out = name_of(folder / "o.exr");
  for (const char* text : {"nan", "inf", "-inf", "1e999", "", "x"}) {
    for (const char* option : {"--exposure", "--shadow-share", "--caustic-radius", "--cut", "--tolerance"})
      EXPECT_TRUE(refused(pellucid({"reference", scene, "-o", out, option, text}), 2, {option}))
          << option << " " << text;
    EXPECT_TRUE(refused(pellucid({"compare", out, out, "--ppd", text}), 2, {"--ppd"})) << text;
  }
  for (const char* device : {"-1", "", "1.5", "egl", "1e0"})
    EXPECT_TRUE(
        refused(pellucid({"render", scene, "-t", "volume_slices", "-o", out, "--device", device}), 2, {"--device"}))
        << device;
  EXPECT_TRUE(refused(pellucid({"sweep", "run", "s.toml", "--limit", "0"}), 2, {"--limit", "1073741824"}));
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(Inputs, AnErrorIsOneLineWhateverTheNameHolds) {
  EXPECT_TRUE(refused(pellucid({"compare", "a\nb\x1b[31m\f.exr", "b.exr"}), 2, {"a\\nb\\x1b[31m\\x0c.exr"}));
  // So is the line that tells what was done.
  const TemporaryFolder folder;
  const Outcome done = pellucid({"render", name_of(write_small_scene(folder)), "-t", "volume_slices", "--size", "8x8",
                                 "-o", name_of(folder / "a\nb\u009b.exr")});
  EXPECT_TRUE(succeeded(done));
  EXPECT_NE(done.err.find("a\\nb\\xc2\\x9b.exr: volume_slices"), std::string::npos) << done.err;
}

TEST(Inputs, WhatIsReadIsNotOverwritten) {
  const TemporaryFolder folder;
  const auto a = write_exr_file(folder / "a.exr", pattern(32, 16)),
             b = write_exr_file(folder / "b.exr", pattern(32, 16));
  const std::string before = read_file(a);
  EXPECT_TRUE(refused(pellucid({"compare", name_of(a), name_of(b), "--map", name_of(a)}), 2, {"--map", "overwrite"}));
  EXPECT_TRUE(
      refused(pellucid({"compare", name_of(b), name_of(b), "--mask", name_of(a), "--map", name_of(a)}), 2, {"--map"}));
  const auto scene =
      write_file(folder / "s.toml",
                 "title = \"t\"\n[views.a]\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n[environment]\nimage = \"a.exr\"\n");
  EXPECT_TRUE(
      refused(pellucid({"reference", name_of(scene), "--size", "8x8", "-o", name_of(a)}), 2, {"-o", "overwrite"}));
  EXPECT_EQ(read_file(a), before);
  const auto paper = write_file(folder / "p.toml", read_file(std::filesystem::path(PELLUCID_SOURCE_DIR) /
                                                             "algorithms/sampling_hulls/paper.toml"));
  EXPECT_TRUE(refused(pellucid({"table", name_of(paper) + ":table1", "-o", name_of(paper)}), 2, {"-o", "overwrite"}));
  const std::string longest = std::string(242, 's') + ".db";
  EXPECT_TRUE(refused(pellucid({"sweep", "run", "sampling_hulls_table1", "--store", longest}), 2,
                      {"its name has 245 bytes; 244 are possible"}));
  for (const char* store : {":memory:", "file:x?mode=memory"})
    EXPECT_TRUE(refused(pellucid({"sweep", "run", "sampling_hulls_table1", "--store", store}), 2, {store, "forget"}));
}

TEST(Inputs, AReferenceIsWrittenInThirtyTwoBits) {
  const TemporaryFolder folder;
  const auto scene = write_small_scene(folder), out = folder / "truth.exr";
  ASSERT_TRUE(succeeded(pellucid({"reference", name_of(scene), "--size", "32x24", "-o", name_of(out)})));
  const ImageFile file = read_image(out);
  std::size_t finer = 0;  // than 16-bit floats: more than 11 significant bits
  for (const float v : file.image.pixels) {
    int exponent = 0;
    const float mantissa = std::frexp(v, &exponent) * 2048;
    finer += mantissa != std::floor(mantissa) ? 1 : 0;
  }
  EXPECT_GT(finer, file.image.pixels.size() / 3);
}

TEST(Inputs, AnEmptyMaskThatNobodyAskedForIsANote) {
  const TemporaryFolder folder;
  ImageFile file;
  file.image = pattern(32, 24);
  file.layers["mask"] = Image(32, 24, 1);
  write_exr(folder / "a.exr", file);
  const std::string a = name_of(folder / "a.exr");
  const Outcome outcome = pellucid({"compare", a, a, "-m", "rmse", "--json"});
  ASSERT_TRUE(succeeded(outcome));
  const json out = json::parse(outcome.out);
  EXPECT_EQ(out.at("mask"), nullptr);
  EXPECT_NE(outcome.err.find("--no-mask"), std::string::npos) << outcome.err;
  EXPECT_EQ(out.at("notes").size(), 1U);
  EXPECT_TRUE(refused(pellucid({"compare", a, a, "-m", "rmse", "--mask", "mask"}), 2, {"marks no pixel"}));
}

TEST(Inputs, AFileThatIsReplacedKeepsItsMode) {
  const TemporaryFolder folder;
  const auto scene = write_small_scene(folder), out = write_file(folder / "o.exr", "old");
  ASSERT_EQ(::chmod(out.c_str(), 0640), 0);
  ASSERT_TRUE(succeeded(pellucid({"reference", name_of(scene), "--size", "8x8", "-o", name_of(out)})));
  EXPECT_EQ(std::filesystem::status(out).permissions(), std::filesystem::perms(0640));
  // As long as names can be.
  const auto longest = folder / (std::string(251, 'n') + ".exr");
  EXPECT_TRUE(succeeded(pellucid({"reference", name_of(scene), "--size", "8x8", "-o", name_of(longest)})));
}

TEST(Inputs, HelpThatNobodyReceivedIsAFailure) {
  EXPECT_EQ(run({"sh", "-c", std::string(PELLUCID_PROGRAM) + " --help > /dev/full"}).status, 1);
}

}  // namespace
}  // namespace pellucid::test
