#pragma once

#include <filesystem>
#include <optional>

namespace pellucid::sandbox {

struct FileOptions {
  std::filesystem::path file;    ///< an EXR that render or reference wrote
  std::filesystem::path folder;  ///< where the new picture goes; made when missing
  std::optional<int> device;
  double tolerance = 0.001;  ///< largest difference of a channel that passes on the same device and commit
  bool json = false;
};

/// Makes the picture again from what the file itself says, and compares the two. Returns the exit status: kRegression
/// when they differ by more than the tolerance though device, driver and commit are the same. Throws InputError when
/// the file does not say how it was made.
int reproduce_file(const FileOptions&);

}  // namespace pellucid::sandbox
