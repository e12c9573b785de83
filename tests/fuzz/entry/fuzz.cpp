// The entry point of libFuzzer; PELLUCID_FUZZ_TARGET names the target.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

#include "tests/fuzz/targets.hpp"

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
  static const pellucid::fuzz::Target& target = pellucid::fuzz::target(PELLUCID_FUZZ_TARGET);
  pellucid::fuzz::run(target, folder, {reinterpret_cast<const char*>(data), size});
  return 0;
}
