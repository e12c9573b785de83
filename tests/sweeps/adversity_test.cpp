// Mishaps of long sweeps: clocks that are set, machines that sleep, workers that are stopped, stores that cannot be
// written.
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sweeps/spec/clock.hpp"
#include "sweeps/store/store.hpp"
#include "sweeps/workers/run.hpp"
#include "sweeps/workers/worker_process.hpp"
#include "tests/sweeps/fake_known_names.hpp"
#include "tests/sweeps/fake_worker.hpp"
#include "tests/sweeps/set_clocks.hpp"

namespace pellucid::sweeps::test {
namespace {
constinit ClockOffsets offsets;
}
ClockOffsets& clock_offsets() {
  return offsets;
}
}  // namespace pellucid::sweeps::test

/// Takes the place of the C library's in this program.
extern "C" int clock_gettime(clockid_t clock, struct timespec* time) noexcept {
  const long status = ::syscall(SYS_clock_gettime, clock, time);
  const auto& offsets = pellucid::sweeps::test::offsets;
  double offset_s = 0;
  if (clock == CLOCK_REALTIME) offset_s = offsets.realtime_s;
  if (clock == CLOCK_MONOTONIC) offset_s = offsets.monotonic_s;
  if (clock == CLOCK_BOOTTIME) offset_s = offsets.boot_s;
  if (status != 0 || offset_s == 0) return static_cast<int>(status);
  const auto ns = static_cast<std::int64_t>(offset_s * 1e9) + time->tv_nsec;
  const std::int64_t below_a_second = (ns % 1'000'000'000 + 1'000'000'000) % 1'000'000'000;
  time->tv_sec += (ns - below_a_second) / 1'000'000'000;
  time->tv_nsec = below_a_second;
  return 0;
}

namespace pellucid::sweeps::test {
namespace {

using nlohmann::json;

class Adversity : public testing::Test {
 protected:
  Adversity() {
    options.worker = self({"fake-worker", log.string(), "a device"});
    options.argv = {"pellucid"};
  }
  ~Adversity() override { offsets.realtime_s = offsets.monotonic_s = offsets.boot_s = 0; }

  /// Runs a sweep and returns what it says.
  std::string run(const std::string& axes, double timeout_s = 60) {
    const Spec spec =
        parse_spec("name = 's'\nmetrics = ['rmse']\ntimeout_s = " + std::to_string(timeout_s) +
                       "\n[[run]]\nname = 'r'\ntechniques = ['faulty']\nscenes = ['ball']\nsizes = ['8x8']\n"
                       "[run.axes]\n" +
                       axes,
                   "s.toml", known_names);
    testing::internal::CaptureStderr();
    summary = run_sweep(spec, make_plan(spec, known_names), store, options);
    return testing::internal::GetCapturedStderr();
  }

  TemporaryFolder folder;
  FakeKnownNames known_names;
  std::filesystem::path store = folder / "s.db", log = folder / "log";
  RunOptions options;
  SweepSummary summary;
};

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++n;
  return n;
}

TEST_F(Adversity, AClockThatIsSetMovesNoTime) {
  const double before = unix_now_s();
  offsets.realtime_s = 3600;
  EXPECT_NEAR(unix_now_s(), before, 1);
  EXPECT_NEAR(clock_set_by_s(), 3600, 1);
  offsets.realtime_s = 0;

  std::thread somebody([] {
    sleep_ms(200);
    offsets.realtime_s = 3600.5;  // half a second more, since times are rounded up to be shown
    sleep_ms(300);
    offsets.realtime_s = -3600;
  });
  const std::string said = run("n = [1, 2, 3, 4]\nsleep_ms = [200]\n");
  somebody.join();
  EXPECT_EQ(summary.measured, 4U);
  EXPECT_EQ(count(said, "note: the machine's clock was set forward by 1 h 0 min; "), 1U) << said;
  EXPECT_EQ(count(said, "note: the machine's clock was set back by 2 h 0 min; "), 1U) << said;
  for (const json& row : read_rows(store)) {
    EXPECT_GT(row.at("done_unix_s").get<double>(), before - 1);
    EXPECT_LT(row.at("done_unix_s").get<double>(), before + 60) << "a jump is an hour";
  }
  EXPECT_EQ(run("n = [1, 2, 3, 4]\nsleep_ms = [200]\n").find("ahead of this machine's clock"), std::string::npos);
}

TEST_F(Adversity, RowsOfTheFutureAreTold) {
  run("n = [1]\n");
  {
    Store out(store, Access::write);
    out.put_row(out.points().at(0).id,
                {{"status", "ok"}, {"device", "a device"}, {"driver", "1.0"}, {"done_unix_s", unix_now_s() + 7199}},
                std::vector<double>{1});
  }
  const std::string said = run("n = [1, 2]\n");
  EXPECT_EQ(count(said, "are 1 h 59 min ahead of this machine's clock"), 1U) << said;
  EXPECT_EQ(read_rows(store).size(), 2U) << "and nothing is lost";
}

TEST_F(Adversity, AMachineThatSleepsIsNoticed) {
  SleepWatch watch;
  for (int i = 0; i < 10000; ++i)
    ASSERT_EQ(watch.slept_s(), 0) << "without any sleep";
  offsets.boot_s = 30;
  EXPECT_NEAR(watch.slept_s(), 30, 0.1);
  EXPECT_EQ(watch.slept_s(), 0) << "told once";
  offsets.boot_s = offsets.boot_s + 0.01;
  EXPECT_NEAR(watch.slept_s(), 0.01, 0.008);
}

// Time that the sweep itself could not run, stopped by a signal, is none of the worker's.
TEST_F(Adversity, AWaitThatWasStoppedGoesOn) {
  WorkerProcess child({"/bin/sh", "-c", "sleep 0.3; echo answer; sleep 5"});
  int turns = 0;
  const auto received = child.receive(std::chrono::steady_clock::now() + std::chrono::seconds(5), [&] {
    if (turns++ == 1) offsets.monotonic_s = 1000;
    return true;
  });
  EXPECT_EQ(received.event, WorkerProcess::Event::line);
  EXPECT_EQ(received.line, "answer");
  EXPECT_EQ(child.receive(std::chrono::steady_clock::now() + std::chrono::milliseconds(10), [] { return true; }).event,
            WorkerProcess::Event::timeout);
}

TEST_F(Adversity, AStoppedWorkerIsToldAndCostsItsPoint) {
  const std::string said = run("does = ['stop', 'good']\n", 1.5);
  EXPECT_EQ(summary.measured, 1U);
  EXPECT_EQ(summary.failed, 1U);
  EXPECT_EQ(count(said, "note: the worker has been stopped by a signal and has 2 s for its point; "), 1U) << said;
  EXPECT_EQ(read_rows(store)[0].at("failure"),
            "the worker was stopped by a signal and took longer than timeout_s = 1.5");
}

TEST_F(Adversity, AStoppedWorkerThatIsLetGoOnCostsNothing) {
  bool over = false;
  std::thread somebody([&] {
    for (int i = 0; i < 300 && !over; ++i, sleep_ms(20)) {
      std::ifstream file("/proc/self/task/" + std::to_string(::getpid()) + "/children");
      for (pid_t child = 0; file >> child;) {
        std::ifstream stat("/proc/" + std::to_string(child) + "/stat");
        std::string number;
        std::string name;
        std::string state;
        stat >> number >> name >> state;
        if (state != "T") continue;
        sleep_ms(1200);  // the parent is to notice first
        ::kill(child, SIGCONT);
        over = true;
      }
    }
  });
  const std::string said = run("does = ['stop']\n");
  somebody.join();
  EXPECT_TRUE(over);
  EXPECT_EQ(summary.measured, 1U);
  EXPECT_EQ(count(said, "note: the worker has been stopped by a signal"), 1U) << said;
}

/// The message of what `f` throws when it runs without root's right to write everything; empty when it throws nothing.
std::string as_anybody(const std::function<void()>& f) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) return "no pipe";
  const pid_t child = ::fork();
  if (child == 0) {
    std::string message;
    constexpr uid_t kNobody = 65534;
    if (::geteuid() == 0 && ::setuid(kNobody) != 0) message = "root stays root";
    try {
      if (message.empty()) f();
    } catch (const std::exception& e) {
      message = e.what();
    }
    ::_exit(::write(ends[1], message.data(), message.size()) == static_cast<ssize_t>(message.size()) ? 0 : 1);
  }
  ::close(ends[1]);
  std::string message;
  std::array<char, 512> chunk{};
  for (ssize_t n = 0; (n = ::read(ends[0], chunk.data(), chunk.size())) > 0;)
    message.append(chunk.data(), static_cast<std::size_t>(n));
  ::close(ends[0]);
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  return message;
}

TEST_F(Adversity, AReadOnlyStoreIsReadAndNotWritten) {
  using std::filesystem::perms;
  run("n = [1, 2]\n");
  std::filesystem::permissions(folder.path(), perms::all);
  std::filesystem::permissions(store, perms::owner_read | perms::group_read | perms::others_read);
  const auto write = [&] { Store(store, Access::write); };
  const auto read = [&] {
    if (read_rows(store).size() != 2) throw std::runtime_error("rows are missing");
  };
  const std::string name = store.string();
  EXPECT_EQ(as_anybody(write), "store '" + name + "' cannot be written: the file is read-only");
  EXPECT_EQ(as_anybody(read), "");
  EXPECT_FALSE(std::filesystem::exists(name + "-lock"));

  std::filesystem::permissions(folder.path(), perms::all & ~(perms::group_write | perms::others_write));
  EXPECT_EQ(as_anybody(write), "store '" + name + "' cannot be written: its folder '" + folder.path().string() +
                                   "' is read-only (Permission denied)");
  EXPECT_EQ(as_anybody(read), "");
  EXPECT_EQ(read_rows(store).size(), 2U);
}

// A sweep that was killed leaves rows in the log; it takes a folder that can be written to bring them in.
TEST_F(Adversity, AReadOnlyFolderWithALogSaysSo) {
  using std::filesystem::perms;
  run("n = [1]\n");
  const std::filesystem::path closed = folder / "closed";
  std::filesystem::create_directory(closed);
  {
    Store writing(store, Access::write);
    writing.remove_point("none");
    writing.put_row(writing.points().at(0).id, {{"status", "ok"}, {"device", "d"}, {"driver", "v"}}, {});
    for (const char* suffix : {"", "-wal"})
      std::filesystem::copy_file(store.string() + suffix, closed / ("s.db" + std::string(suffix)));
  }
  std::filesystem::permissions(folder.path(), perms::all);
  std::filesystem::permissions(
      closed, perms::owner_all | perms::group_read | perms::group_exec | perms::others_read | perms::others_exec);
  const std::string name = (closed / "s.db").string();
  EXPECT_EQ(as_anybody([&] { read_rows(name); }),
            "store '" + name + "' has rows in its log, " + name +
                "-wal, which only a program that may write their folder can read; copy both files to another folder");
}

}  // namespace
}  // namespace pellucid::sweeps::test
