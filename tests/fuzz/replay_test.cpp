// Every file of the corpus and some mutants of each through its reader: what fails in a long run of the fuzzers is put
// into the corpus and stays mended.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "tests/fuzz/targets.hpp"
#include "tests/temporary_folder.hpp"

namespace pellucid::fuzz {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> corpus_of(const Target& target) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(PELLUCID_SOURCE_DIR) / "tests/fuzz/corpus" / target.name))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<std::string> contents;
  for (const fs::path& path : files) {
    std::ifstream file(path, std::ios::binary);
    contents.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return contents;
}

/// One to four changes: a byte, a number of the awkward kind, a part taken out or repeated, the end cut off.
std::string mutant(std::string bytes, std::mt19937& random) {
  static constexpr std::array<std::string_view, 10> kAwkward = {
      "-1", "0", "nan", "1e999", "4294967296", "99999999999999999999", "\n", "\xff\xff\xff\xff", " ", "inf"};
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
    const std::size_t at = below(bytes.size() + 1), length = 1 + below(16);
    switch (below(6)) {
      case 0:
        if (at < bytes.size()) bytes[at] = static_cast<char>(random());
        break;
      case 1:
        if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 2:
        bytes.insert(at, kAwkward[below(kAwkward.size())]);
        break;
      case 3:
        if (at < bytes.size()) bytes.erase(at, length);
        break;
      case 4:
        if (at < bytes.size()) bytes.insert(at, bytes.substr(at, length));
        break;
      default:
        if (below(4) == 0) bytes.resize(at);
    }
  }
  return bytes;
}

class Replay : public ::testing::TestWithParam<std::size_t> {};

TEST_P(Replay, NeitherCrashesNorHangs) {
  const Target& target = targets()[GetParam()];
  const std::vector<std::string> corpus = corpus_of(target);
  ASSERT_FALSE(corpus.empty()) << target.name;
  const test::TemporaryFolder folder;
  std::mt19937 random(1);
  // Opening a store or a colour config takes milliseconds.
  const bool slow = target.name == "store" || target.name == "ocio" || target.name == "paper" || target.name == "spec";
  const int mutants = slow ? 10 : 100;
  const auto timed = [&](const std::string& bytes) {
    const auto start = std::chrono::steady_clock::now();
    run(target, folder.path(), bytes);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5)) << target.name;
  };
  for (const std::string& file : corpus) {
    timed(file);
    for (int i = 0; i < mutants; ++i)
      timed(mutant(file, random));
  }
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Replay, ::testing::Range(std::size_t{0}, targets().size()),
                         [](const auto& target) { return std::string(targets()[target.param].name); });

}  // namespace
}  // namespace pellucid::fuzz
