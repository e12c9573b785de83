#pragma once

#include <string>
#include <vector>

namespace pellucid::sweeps::test {

/// This test program with arguments: `fake-worker LOG`, `fake-sweep STORE LOG` and so on (fake_worker.cpp).
std::vector<std::string> self(std::vector<std::string> arguments);

/// Writes rows to a store beside others that do (writers_test.cpp).
int run_writer(const std::string& store, int first);

void sleep_ms(int ms);

/// Runs what main() was asked for instead of the tests.
int run_role(const std::vector<std::string>& arguments);

/// The spec that a `fake-sweep` runs; `points` points of `sleep_ms` each.
std::string fake_spec(int points, int sleep_ms, int frames);

}  // namespace pellucid::sweeps::test
