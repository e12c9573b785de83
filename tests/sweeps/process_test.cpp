#include "sweeps/workers/process.hpp"

#include <string>

#include <gtest/gtest.h>

namespace pellucid::sweeps {
namespace {

ProcessResult shell(const std::string& script) {
  return run_process({"sh", "-c", script});
}

TEST(Process, BothStreamsComeWholeHoweverMuchIsWritten) {
  // More than a pipe holds, first into the stream that a careless reader would leave for later.
  const ProcessResult result = shell("head -c 300000 /dev/zero >&2; head -c 200000 /dev/zero; exit 3");
  EXPECT_EQ(result.status, 3);
  EXPECT_EQ(result.output.size(), 200'000U);
  EXPECT_EQ(result.diagnostics.size(), 300'000U);
}

TEST(Process, TellsASignal) {
  EXPECT_EQ(shell("kill -TERM $$").status, 128 + 15);
}

TEST(Process, AMissingProgramEndsWith127) {
  const ProcessResult result = run_process({"no-such-program-anywhere"});
  EXPECT_EQ(result.status, 127);
  EXPECT_FALSE(result.diagnostics.empty());
}

TEST(Process, StandardInputIsEmpty) {
  EXPECT_EQ(shell("wc -c").output.find_first_not_of(" 0\n"), std::string::npos);
}

TEST(Process, ArgumentsAreNoShellWords) {
  EXPECT_EQ(run_process({"printf", "%s", "$HOME; `ls`"}).output, "$HOME; `ls`");
}

}  // namespace
}  // namespace pellucid::sweeps
