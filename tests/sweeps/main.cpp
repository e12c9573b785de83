#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/sweeps/fake_worker.hpp"

/// The tests, or with a role for its first argument the process that one of them starts.
int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (!arguments.empty() && !arguments[0].starts_with("--")) return pellucid::sweeps::test::run_role(arguments);
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
