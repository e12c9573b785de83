#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json_fwd.hpp>

#include "tests/temporary_folder.hpp"

/// Runs the built program as a user's shell would, and looks at what it says.
namespace pellucid::test {

/// How a process ended, and all that it wrote.
struct Outcome {
  int status = -1;  ///< exit status; −1 when a signal ended it
  int signal = 0;
  double wall_s = 0;
  std::string out, err;
};

struct Setting {
  std::filesystem::path folder{};                    ///< working directory; empty: this process's own
  std::map<std::string, std::string> environment{};  ///< added to this process's own
};

/// Waits for it to end. The first word is looked up in $PATH.
Outcome run(const std::vector<std::string>& command, const Setting& = {});
/// The same for the program under test.
Outcome pellucid(std::vector<std::string> arguments, const Setting& = {});

/// Started and not waited for; killed with its group when it goes out of scope.
class Background {
 public:
  explicit Background(const std::vector<std::string>& command, const Setting& = {});
  ~Background();
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  /// To the whole process group, then waits for the leader's end.
  void stop(int signal);
  bool running();

 private:
  int pid_ = -1;
};

/// True if it ended with `status` and its standard error holds exactly one line that begins with "error: ", which
/// contains every one of `parts`; with status 2 that line is all it says, and standard output stays empty.
testing::AssertionResult refused(const Outcome&, int status, const std::vector<std::string>& parts);
/// True if it ended with status 0; shows what it said otherwise.
testing::AssertionResult succeeded(const Outcome&);

/// A scene of one lit floor and one small box of fog, 64 by 48 pixels in a blink. Returns its path.
std::filesystem::path write_small_scene(const TemporaryFolder&);

}  // namespace pellucid::test
