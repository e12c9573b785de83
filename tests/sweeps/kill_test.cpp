// Sweeps that are killed, and sweeps that find the disk full.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "gl/error.hpp"
#include "sweeps/store/store.hpp"
#include "tests/sweeps/fake_known_names.hpp"
#include "tests/sweeps/fake_worker.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;
using test::self;
using test::TemporaryFolder;

/// Starts this program in a role and returns its process; `errors`: where its standard error goes.
pid_t start(const std::vector<std::string>& command, const std::string& errors = "") {
  const pid_t pid = ::fork();
  if (pid != 0) return pid;
  std::vector<char*> argv;
  for (const std::string& word : command)
    argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  if (!errors.empty() && ::freopen(errors.c_str(), "w", stderr) == nullptr) ::_exit(126);
  ::execv(argv[0], argv.data());
  ::_exit(127);
}

int wait_for(pid_t pid) {
  int status = 0;
  EXPECT_EQ(::waitpid(pid, &status, 0), pid);
  return status;
}

bool done(int status) {
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// A sweep of `points` points of `sleep_ms` each, with `frames` samples in a row.
struct FakeSweep {
  std::filesystem::path store, log;
  int points, sleep_ms, frames;

  std::vector<std::string> command(const char* role = "fake-sweep") const {
    return self(
        {role, store.string(), log.string(), std::to_string(points), std::to_string(sleep_ms), std::to_string(frames)});
  }
  /// How many points its workers were asked for.
  std::size_t asked() const {
    std::ifstream file(log);
    std::size_t lines = 0;
    for (std::string line; std::getline(file, line);)
      ++lines;
    return lines;
  }
  /// The stored part of each point; nothing while there is no store, or one without its tables.
  std::vector<json> rows() const {
    try {
      return std::filesystem::exists(store) ? read_rows(store, true) : std::vector<json>{};
    } catch (const InputError&) {
      return {};
    }
  }
};

/// All columns but the time of day and how long it took.
std::vector<json> timeless(std::vector<json> rows) {
  for (json& row : rows) {
    EXPECT_EQ(row.erase("started_utc") + row.erase("done_unix_s") + row.erase("wall_s"), 3U);
    EXPECT_GT(row.size(), 30U) << "there is something to compare";
  }
  return rows;
}

/// The worker of a sweep; 0 when it has none at the moment.
pid_t worker_of(pid_t sweep) {
  std::ifstream file("/proc/" + std::to_string(sweep) + "/task/" + std::to_string(sweep) + "/children");
  pid_t worker = 0;
  file >> worker;
  return worker;
}

// Killed at twenty random moments, the parent, its worker or both: a few within the start, the others while a point is
// in work or its row is being written.
TEST(KilledSweep, LeavesTheRowsOfOneThatWasNot) {
  const TemporaryFolder folder;
  const FakeSweep killed{folder / "killed.db", folder / "killed.log", 120, 4, 50};
  std::mt19937 random(2007);
  std::vector<json> before;
  for (std::size_t kill = 1; kill <= 20; ++kill) {
    const std::size_t moment = killed.asked() + random() % 5;       // after so many points in all …
    const auto later = std::chrono::microseconds(random() % 8000);  // … and so much later
    const pid_t pid = start(killed.command());
    for (int ms = 0; ms < 60'000 && killed.asked() < moment; ++ms)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::this_thread::sleep_for(later);
    if (const pid_t worker = worker_of(pid); worker > 0 && kill % 3 != 0) {
      ::kill(worker, SIGKILL);  // it may just have ended by itself
      if (kill % 3 == 1) std::this_thread::sleep_for(std::chrono::milliseconds(random() % 30));
    }
    ASSERT_EQ(::kill(pid, SIGKILL), 0);
    ASSERT_TRUE(WIFSIGNALED(wait_for(pid))) << "it was over before it could be killed";
    const std::vector<json> stored = killed.rows();
    ASSERT_GE(stored.size(), before.size()) << "a row was lost";
    for (const json& row : before)
      EXPECT_NE(std::find(stored.begin(), stored.end(), row), stored.end()) << "a row has changed";
    EXPECT_LE(killed.asked(), stored.size() + 2 * kill) << "more than the point in work was done again";
    before = stored;
  }
  EXPECT_GT(before.size(), 5U);
  EXPECT_LT(before.size(), 120U);
  ASSERT_TRUE(done(wait_for(start(killed.command()))));

  const FakeSweep whole{folder / "whole.db", folder / "whole.log", 120, 4, 50};
  ASSERT_TRUE(done(wait_for(start(whole.command()))));
  std::vector<json> expected = timeless(whole.rows()), rows = timeless(killed.rows());
  ASSERT_EQ(expected.size(), 120U);
  ASSERT_EQ(rows.size(), expected.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    EXPECT_EQ(rows[i], expected[i]) << i;
}

TEST(FullDisk, KeepsTheRowsThatAreThereAndSaysSo) {
  const TemporaryFolder folder;
  const std::string errors = (folder / "errors").string();
  const FakeSweep sweep{folder / "s.db", folder / "s.log", 40, 0, 5000};
  const int status = wait_for(start(sweep.command("full-disk-sweep"), errors));
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  std::ifstream file(errors);
  std::string message;
  std::getline(file, message);
  for (const char* part : {"s.db", "cannot be written: ", "Rows stored so far stay"})
    EXPECT_NE(message.find(part), std::string::npos) << message;
  // Every point that was asked for but the last, whose row did not fit, is there.
  const std::vector<json> kept = sweep.rows();
  EXPECT_GE(kept.size(), 3U);
  EXPECT_LT(kept.size(), 40U);
  EXPECT_EQ(kept.size() + 1, sweep.asked());
  // With room again the sweep goes on, and keeps them as they are.
  ASSERT_TRUE(done(wait_for(start(sweep.command()))));
  const std::vector<json> all = sweep.rows();
  EXPECT_EQ(all.size(), 40U);
  for (const json& row : kept)
    EXPECT_NE(std::find(all.begin(), all.end(), row), all.end()) << "a row has changed";
}

}  // namespace
}  // namespace pellucid::sweeps
