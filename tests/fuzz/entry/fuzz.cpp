// The entry points of libFuzzer, which passes over options that begin with two dashes: --target=NAME is ours.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "tests/fuzz/targets.hpp"

namespace {

const pellucid::fuzz::Target* chosen = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  constexpr std::string_view kOption = "--target=";
  for (int i = 1; i < *argc; ++i) {
    const std::string_view argument = (*argv)[i];
    if (!argument.starts_with(kOption)) continue;
    for (const pellucid::fuzz::Target& target : pellucid::fuzz::targets())
      if (target.name == argument.substr(kOption.size())) chosen = &target;
  }
  if (chosen != nullptr) return 0;
  fmt::print(stderr, "usage: fuzz --target=NAME [libFuzzer's options] [FOLDER...]\nNAME is one of");
  for (const pellucid::fuzz::Target& target : pellucid::fuzz::targets())
    fmt::print(stderr, " {}", target.name);
  fmt::print(stderr, "\n");
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace fs = std::filesystem;
  // In memory where there is such a file system: a million files a run.
  static const fs::path folder = [] {
    const fs::path memory = "/dev/shm";
    std::error_code error;
    const fs::path made = (fs::is_directory(memory, error) ? memory : fs::temp_directory_path()) /
                          fmt::format("pellucid-fuzz-{}", ::getpid());
    fs::create_directories(made);
    return made;
  }();
  pellucid::fuzz::run(*chosen, folder, {reinterpret_cast<const char*>(data), size});
  return 0;
}
