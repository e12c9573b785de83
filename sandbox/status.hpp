#pragma once

namespace pellucid::sandbox {

/// Exit statuses of the program.
enum Status { kDone = 0, kFailed = 1, kBadInput = 2, kRegression = 3 };

}  // namespace pellucid::sandbox
