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

namespace fs = std::filesystem;

const pellucid::fuzz::Target* chosen = nullptr;

/// For the inputs of this process: in memory where there is such a file system, since a run writes a million files.
struct Folder {
  fs::path path;
  Folder() {
    const fs::path memory = "/dev/shm";
    std::error_code error;
    path = (fs::is_directory(memory, error) ? memory : fs::temp_directory_path()) /
           fmt::format("pellucid-fuzz-{}", ::getpid());
    fs::create_directories(path);
  }
  ~Folder() {
    std::error_code error;
    fs::remove_all(path, error);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
};

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
  static const Folder folder;
  pellucid::fuzz::run(*chosen, folder.path, {reinterpret_cast<const char*>(data), size});
  return 0;
}
