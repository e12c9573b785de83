#include "plots/charts/scratch_file.hpp"

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "gl/error.hpp"

namespace pellucid::plots {

ScratchFile::ScratchFile() {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  if (error) throw RuntimeError(fmt::format("no folder for temporary files (TMPDIR): {}", error.message()));
  std::string name = (folder / "pellucid-XXXXXX").string();
  const int descriptor = mkstemp(name.data());
  if (descriptor < 0) {
    throw RuntimeError(fmt::format("cannot make a temporary file in '{}': {}", folder.string(),
                                   std::generic_category().message(errno)));
  }
  close(descriptor);
  path_ = name;
}

ScratchFile::~ScratchFile() {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace pellucid::plots
