#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

/// One target for each kind of file that the program reads. libFuzzer drives them (fuzz.cpp, preset `fuzz`), and the
/// tests a few mutants of the corpus (replay_test.cpp).
namespace pellucid::fuzz {

struct Target {
  std::string_view name;       ///< of its folder in the corpus
  std::string_view extension;  ///< by which the program knows the format
  /// Reads the file. Bad input leaves it as InputError or RuntimeError; anything else is a bug.
  std::function<void(const std::filesystem::path&)> read;
};

std::span<const Target> targets();
const Target& target(std::string_view name);

/// Puts the bytes into a file of the target's kind in `folder` and reads it.
void run(const Target&, const std::filesystem::path& folder, std::string_view bytes);

}  // namespace pellucid::fuzz
