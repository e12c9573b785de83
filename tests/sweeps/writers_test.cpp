// Many processes that write one store, on file systems whose locks do and do not work.
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "gl/error.hpp"
#include "sweeps/store/store.hpp"
#include "tests/sweeps/fake_known_names.hpp"
#include "tests/sweeps/fake_worker.hpp"

/// Takes the place of the C library's in this program: with $PELLUCID_TEST_NO_FLOCK every lock is granted, as on file
/// systems that do not pass it on to other machines.
extern "C" int flock(int file, int operation) {
  if (std::getenv("PELLUCID_TEST_NO_FLOCK") != nullptr) return 0;
  return static_cast<int>(::syscall(SYS_flock, file, operation));
}

namespace pellucid::sweeps::test {

constexpr int kWriters = 6;
constexpr int kRowsEach = 8;

/// The role `writer STORE FIRST`: opens the store anew for each of its rows, as separate sweeps would.
int run_writer(const std::string& store, int first) {
  for (int i = first; i < first + kRowsEach; ++i) {
    for (int attempt = 0;; ++attempt) {
      try {
        Store out(store, Access::write);
        out.put_row(fmt::format("{:016x}", i), {{"status", "ok"}, {"device", "d"}, {"driver", "v"}, {"n", i}},
                    std::vector<double>{1.0 * i});
        break;
      } catch (const RuntimeError& e) {
        if (attempt == 5000) {
          fmt::print(stderr, "{}\n", e.what());
          return 1;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
    }
  }
  return 0;
}

namespace {

class Writers : public testing::Test {
 protected:
  ~Writers() override {
    ::unsetenv("PELLUCID_TEST_NO_FLOCK");
    ::unsetenv("PELLUCID_NETWORK_STORES");
  }
  void write_together() {
    const std::string path = (folder / "s.db").string();
    std::vector<pid_t> writers;
    for (int w = 0; w < kWriters; ++w) {
      const std::vector<std::string> command = self({"writer", path, std::to_string(w * kRowsEach)});
      const pid_t pid = ::fork();
      if (pid == 0) {
        std::vector<char*> argv;
        for (const std::string& word : command)
          argv.push_back(const_cast<char*>(word.c_str()));
        argv.push_back(nullptr);
        ::execv(argv[0], argv.data());
        ::_exit(127);
      }
      writers.push_back(pid);
    }
    for (const pid_t pid : writers) {
      int status = 0;
      ASSERT_EQ(::waitpid(pid, &status, 0), pid);
      EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    }
    std::set<std::string> ids;
    for (const StoredPoint& point : Store(path, Access::read).points())
      ids.insert(point.id);
    EXPECT_EQ(ids.size(), static_cast<std::size_t>(kWriters * kRowsEach)) << "a row was lost";
    EXPECT_FALSE(std::filesystem::exists(path + "-lock"));
  }
  TemporaryFolder folder;
};

TEST_F(Writers, LoseNoRow) {
  write_together();
}

TEST_F(Writers, LoseNoRowWhereFlockDoesNothing) {
  ::setenv("PELLUCID_TEST_NO_FLOCK", "1", 1);
  write_together();
}

TEST_F(Writers, LoseNoRowOnASharedFileSystem) {
  ::setenv("PELLUCID_NETWORK_STORES", "1", 1);
  ::setenv("PELLUCID_TEST_NO_FLOCK", "1", 1);
  write_together();
}

}  // namespace
}  // namespace pellucid::sweeps::test
