#include "sweeps/workers/run.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>
#include <unistd.h>

#include "gl/error.hpp"
#include "sweeps/store/merge.hpp"
#include "sweeps/store/store.hpp"
#include "sweeps/workers/worker_process.hpp"
#include "tests/sweeps/fake_known_names.hpp"
#include "tests/sweeps/fake_worker.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;
using test::FakeKnownNames;
using test::input_error;
using test::self;
using test::TemporaryFolder;

class Sweep : public testing::Test {
 protected:
  Sweep() {
    options.worker = self({"fake-worker", log.string(), "a device"});
    options.argv = {"pellucid", "sweep", "run", "a b.toml"};
    options.quiet = true;
  }
  SweepSummary run(const std::string& text) {
    const Spec spec = parse_spec(text, "s.toml", known_names);
    return run_sweep(spec, make_plan(spec, known_names), store, options);
  }
  /// The points that the fake workers were asked for, in order.
  std::vector<std::string> requests() const {
    std::ifstream file(log);
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);)
      lines.push_back(line);
    return lines;
  }
  static std::string spec(const std::string& rest) {
    return "name = 's'\nmetrics = ['rmse']\n" + rest +
           "[[run]]\nname = 'r'\ntechniques = ['faulty']\nscenes = ['ball']\nsizes = ['8x8']\n";
  }

  TemporaryFolder folder;
  FakeKnownNames known_names;
  std::filesystem::path store = folder / "s.db";
  std::filesystem::path log = folder / "log";
  RunOptions options;
};

TEST_F(Sweep, RecordsWhereARowComesFrom) {
  const SweepSummary summary = run(spec("") + "[run.axes]\nn = [1, 2, 3]\nscene.density = [0.1]\n");
  EXPECT_EQ(summary.planned, 3U);
  EXPECT_EQ(summary.measured, 3U);
  EXPECT_EQ(summary.failed, 0U);
  EXPECT_EQ(summary.left, 0U);
  const std::vector<json> rows = read_rows(store, true);
  ASSERT_EQ(rows.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const json& row = rows[i];
    EXPECT_EQ(row.at("n"), i + 1);
    EXPECT_EQ(row.at("scene.density"), 0.1);
    EXPECT_EQ(row.at("frame.format"), "half");
    EXPECT_EQ(row.at("technique"), "faulty");
    EXPECT_EQ(row.at("scene"), "ball");
    EXPECT_EQ(row.at("view"), "near");
    EXPECT_EQ(row.at("width"), 8);
    EXPECT_EQ(row.at("status"), "ok");
    EXPECT_EQ(row.at("device"), "a device");
    EXPECT_FALSE(row.at("host").get<std::string>().empty());
    EXPECT_EQ(row.at("driver"), "1.0");
    EXPECT_EQ(row.at("clock"), "finish");
    EXPECT_EQ(row.at("argv"), "pellucid sweep run 'a b.toml'");
    EXPECT_EQ(row.at("scene_hash"), "hash of the ball");
    EXPECT_EQ(row.at("code_hash"), "code 1 of faulty");
    EXPECT_TRUE(row.at("commit").is_string());
    EXPECT_TRUE(row.at("dirty").is_boolean());
    EXPECT_EQ(row.at("started_utc").get<std::string>().size(), 20U);
    EXPECT_TRUE(row.at("psnr").is_null());  // equal images: infinite
    EXPECT_EQ(row.at("frame_ms_samples").size(), 30U);
  }
}

TEST_F(Sweep, GoesOnAfterEveryKindOfFailure) {
  const SweepSummary summary =
      run(spec("timeout_s = 3\n") +
          "[run.axes]\ndoes = ['good', 'fail', 'crash', 'abort', 'hang', 'nan', 'garbage', 'truncate', "
          "'leave', 'unconverged']\n");
  EXPECT_EQ(summary.measured, 2U);
  EXPECT_EQ(summary.failed, 8U);
  EXPECT_EQ(summary.unconverged, 1U);
  std::map<std::string, json> rows;
  for (const json& row : read_rows(store))
    rows[row.at("does")] = row;
  ASSERT_EQ(rows.size(), 10U);
  const auto failure = [&](const char* does) {
    EXPECT_EQ(rows.at(does).at("status"), "failed");
    EXPECT_FALSE(rows.at(does).contains("frame_ms_median"));
    EXPECT_EQ(rows.at(does).at("repeat").get<std::string>().find(
                  std::string("pellucid render ball -t faulty -s does=") + does + " --view near --size 8x8 -o "),
              0U);
    return rows.at(does).at("failure").get<std::string>();
  };
  EXPECT_EQ(rows.at("good").at("status"), "ok");
  EXPECT_EQ(rows.at("unconverged").at("timing"), "unconverged");
  EXPECT_EQ(failure("fail"), "the scene has no volume");
  EXPECT_EQ(failure("crash").substr(0, 34), "the worker was killed by signal 11");
  EXPECT_EQ(failure("abort").substr(0, 33), "the worker was killed by signal 6");
  EXPECT_NE(failure("abort").find("; its last words: assertion of the fake failed"), std::string::npos);
  EXPECT_EQ(failure("hang"), "the worker took longer than timeout_s = 3");
  EXPECT_EQ(failure("nan"), "frame_ms_median is not a finite number");
  EXPECT_EQ(failure("garbage"), "the worker sent what is no answer: 'Mesa: chatter on standard output'");
  EXPECT_EQ(failure("truncate"), "the worker's answer breaks off: '{\"type\": \"done\", \"id\": \"'");
  EXPECT_EQ(failure("leave"), "the worker ended with status 7");
}

// Somebody, or the kernel for want of memory: the point is tried once more before it counts as failed.
TEST_F(Sweep, APointWhoseWorkerIsKilledIsTriedAgain) {
  const SweepSummary summary = run(spec("") + "[run.axes]\ndoes = ['killed', 'good']\n");
  EXPECT_EQ(summary.measured, 1U);
  EXPECT_EQ(summary.failed, 1U);
  EXPECT_EQ(requests().size(), 3U);
  EXPECT_EQ(read_rows(store)[0].at("failure").get<std::string>().substr(0, 33), "the worker was killed by signal 9");
}

TEST_F(Sweep, AFinishedOneDoesNothing) {
  const std::string text = spec("") + "[run.axes]\nn = [1, 2, 3]\ndoes = ['good', 'fail']\n";
  run(text);
  const std::size_t asked = requests().size();
  options.worker = {"/nonexistent/worker"};  // would throw if it were started
  const SweepSummary again = run(text);
  EXPECT_EQ(again.reused, 6U);
  EXPECT_EQ(again.measured + again.failed + again.left, 0U);
  EXPECT_EQ(requests().size(), asked);
}

TEST_F(Sweep, RetriesFailuresOnlyWhenAsked) {
  const std::string text = spec("") + "[run.axes]\nn = [1, 2]\ndoes = ['good', 'fail']\n";
  run(text);
  options.retry_failed = true;
  const SweepSummary again = run(text);
  EXPECT_EQ(again.reused, 2U);
  EXPECT_EQ(again.failed, 2U);
}

TEST_F(Sweep, ALimitLeavesTheRest) {
  const std::string text = spec("") + "[run.axes]\nn = [1, 2, 3, 4, 5]\n";
  options.limit = 2;
  EXPECT_EQ(run(text).left, 3U);
  EXPECT_EQ(run(text).left, 1U);
  EXPECT_EQ(run(text).left, 0U);
  const std::vector<std::string> asked = requests();
  EXPECT_EQ(asked.size(), 5U);
  EXPECT_EQ(std::set<std::string>(asked.begin(), asked.end()).size(), 5U);
}

TEST_F(Sweep, GivesUpAfterSoManyFailures) {
  options.fail_after = 2;
  const SweepSummary summary = run(spec("") + "[run.axes]\nn = [1, 2, 3, 4, 5, 6, 7, 8]\n[run.fixed]\ndoes = 'fail'\n");
  EXPECT_TRUE(summary.gave_up);
  EXPECT_EQ(summary.failed, 2U);
  EXPECT_EQ(summary.left, 6U);
  EXPECT_EQ(requests().size(), 2U);
}

TEST_F(Sweep, MeasuresTheBaselineFirstBetweenAndLast) {
  const SweepSummary summary = run(spec("") + "baseline = true\n[run.axes]\nn = { from = 1, to = 20, steps = 20 }\n");
  std::string kinds;
  for (const std::string& request : requests())
    kinds += request[0];
  EXPECT_EQ(kinds, "tmmmmmmmmtmmmmmmmmtmmmmt");
  EXPECT_EQ(summary.baseline_drift, 0.0);
  EXPECT_EQ(read_rows(store)[0].at("baseline_drift"), 0.0);
  EXPECT_EQ(Store(store, Access::read).baselines("s").size(), 4U);
}

TEST_F(Sweep, ABrokenBaselineCostsOnlyTheDrift) {
  const SweepSummary summary = run(spec("") + "baseline = true\n[run.axes]\ndoes = ['crash', 'good']\n");
  EXPECT_EQ(summary.measured, 1U);
  EXPECT_EQ(summary.failed, 1U);
  EXPECT_FALSE(summary.baseline_drift.has_value());
}

TEST_F(Sweep, NeverPoolsDevices) {
  const std::string text = spec("") + "[run.axes]\nn = [1, 2]\n";
  run(text);
  options.worker = self({"fake-worker", log.string(), "another device"});
  EXPECT_EQ(run(text).reused, 2U) << "nothing is missing, so no worker was asked";
  const SweepSummary more = run(spec("") + "[run.axes]\nn = [1, 2, 3]\n");
  EXPECT_EQ(more.measured, 3U) << "each point is measured on the other device too";
  EXPECT_EQ(more.device, "another device, 1.0");
  EXPECT_EQ(Store(store, Access::read).points().size(), 5U);
  const std::vector<json> rows = read_rows(store);
  ASSERT_EQ(rows.size(), 5U);
  EXPECT_EQ(std::count_if(rows.begin(), rows.end(), [](const json& row) { return row.at("device") == "a device"; }), 2);
}

TEST_F(Sweep, SeveralWorkersShareThePoints) {
  options.devices = {0, 1, 3};
  const SweepSummary summary =
      run(spec("") + "baseline = true\n[run.axes]\nn = { from = 1, to = 60, steps = 60 }\n[run.fixed]\nsleep_ms = 5\n");
  EXPECT_EQ(summary.measured, 60U);
  EXPECT_EQ(summary.left, 0U);
  std::multiset<std::string> measured;
  for (const std::string& request : requests()) {
    if (request[0] == 'm') measured.insert(request);
  }
  EXPECT_EQ(measured.size(), 60U);
  EXPECT_EQ(std::set<std::string>(measured.begin(), measured.end()).size(), 60U) << "none twice";
  EXPECT_EQ(read_rows(store).size(), 60U);
  const std::vector<RunRecord> runs = Store(store, Access::read).runs();
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_EQ(runs[0].points, 60U);
  EXPECT_GT(runs[0].measuring_s, 0);
  EXPECT_LE(runs[0].measuring_s, runs[0].wall_s);
}

TEST_F(Sweep, SeveralWorkersStopAtAnError) {
  options.devices = {0, 1};
  options.fail_after = 3;
  const SweepSummary summary =
      run(spec("") + "[run.axes]\nn = { from = 1, to = 60, steps = 60 }\n[run.fixed]\ndoes = 'fail'\nsleep_ms = 5\n");
  EXPECT_TRUE(summary.gave_up);
  EXPECT_GE(summary.failed, 3U);
  EXPECT_LE(summary.failed, 4U);
}

TEST_F(Sweep, ShardsDivideThePointsAndMergeToTheWhole) {
  const std::string text = spec("") + "[run.axes]\nn = { from = 1, to = 50, steps = 50 }\n";
  run(text);
  const auto timeless = [](const std::filesystem::path& path) {
    std::map<std::string, json> rows;
    for (json row : read_rows(path, true)) {
      for (const char* field : {"started_utc", "done_unix_s", "wall_s"})
        row.erase(field);
      rows[row.at("point")] = row;
    }
    return rows;
  };
  const auto whole = timeless(store);
  ASSERT_EQ(whole.size(), 50U);
  std::mt19937 random(5);
  for (const std::size_t count : {1U, 3U, 16U}) {
    std::vector<std::filesystem::path> parts;
    std::size_t planned = 0;
    for (std::size_t i = 1; i <= count; ++i) {
      store = folder / ("part" + std::to_string(count) + "." + std::to_string(i) + ".db");
      options.shard = {i, count};
      planned += run(text).measured;
      parts.push_back(store);
    }
    EXPECT_EQ(planned, 50U);
    for (const char* merged : {"a.db", "b.db"}) {
      std::shuffle(parts.begin(), parts.end(), random);
      const std::filesystem::path path = folder / (std::to_string(count) + merged);
      const MergeSummary summary = merge_stores(path, parts);
      EXPECT_EQ(summary.rows, 50U);
      EXPECT_EQ(summary.added, 50U);
      EXPECT_EQ(timeless(path), whole) << count;
      EXPECT_EQ(merge_stores(path, parts).duplicates, 50U) << "again changes nothing";
      EXPECT_EQ(timeless(path), whole) << count;
    }
  }
}

TEST_F(Sweep, AMergeTellsConflictsFromRepeats) {
  const std::string text = spec("") + "[run.axes]\nn = [1, 2, 3]\n";
  const std::filesystem::path a = store = folder / "a.db";
  run(text);
  const std::filesystem::path b = store = folder / "b.db";
  run(text);
  const MergeSummary repeats = merge_stores(folder / "ab.db", {a, b});
  EXPECT_EQ(repeats.rows, 3U);
  EXPECT_EQ(repeats.repeats, 3U);
  EXPECT_TRUE(repeats.conflicts.empty());
  merge_stores(folder / "ba.db", {b, a});
  EXPECT_EQ(read_rows(folder / "ab.db", true), read_rows(folder / "ba.db", true)) << "in any order";

  const std::string id = read_rows(b)[0].at("point");
  {
    Store changed(b, Access::write);
    json row = read_rows(b)[0];
    for (const char* field : {"point", "sweep", "block", "baseline_drift"})
      row.erase(field);
    row["rmse"] = 0.9;
    changed.put_row(id, row, {});
  }
  const std::string message = input_error([&] { merge_stores(folder / "c.db", {a, b}); });
  EXPECT_NE(message.find("1 point was measured twice with different results"), std::string::npos) << message;
  EXPECT_NE(message.find("rmse: "), std::string::npos) << message;
  EXPECT_FALSE(std::filesystem::exists(folder / "c.db")) << "nothing is left of a merge that failed";
  EXPECT_EQ(merge_stores(folder / "c.db", {a, b}, Prefer::newest).conflicts.size(), 1U);
  EXPECT_EQ(read_rows(folder / "c.db").size(), 3U);

  store = folder / "d.db";
  run(spec("") + "[run.axes]\nn = [1, 2]\n");
  EXPECT_NE(input_error([&] {
              merge_stores(folder / "e.db", {a, store});
            }).find("different plans of the sweep s"),
            std::string::npos);
}

TEST(Shard, IsReadFromText) {
  EXPECT_EQ(parse_shard("2/16").index, 2U);
  EXPECT_EQ(parse_shard("2/16").count, 16U);
  for (const char* bad : {"0/3", "4/3", "1/0", "1", "a/b", "1/2/3", "-1/3", ""})
    EXPECT_NE(input_error([&] { parse_shard(bad); }).find("is not i/N"), std::string::npos) << bad;
}

TEST_F(Sweep, AWarningEndsBetweenTwoPoints) {
  const std::string text = spec("") + "[run.axes]\nn = { from = 1, to = 40, steps = 40 }\n[run.fixed]\nsleep_ms = 30\n";
  std::thread warner([&] {
    while (requests().size() < 4)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ::kill(::getpid(), SIGUSR1);
  });
  const SweepSummary first = run(text);
  warner.join();
  EXPECT_TRUE(first.interrupted);
  EXPECT_GT(first.left, 0U);
  EXPECT_EQ(requests().size(), first.measured) << "the point in work was ended, not thrown away";
}

TEST_F(Sweep, SaysWhyNoWorkerStarts) {
  const auto error = [&](std::vector<std::string> worker, const char* timeout_s = "30") {
    options.worker = std::move(worker);
    try {
      run(spec(std::string("timeout_s = ") + timeout_s + "\n") + "[run.axes]\nn = [1]\n");
    } catch (const RuntimeError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(error(self({"dead-worker", "1"})), "no render worker: it ended with status 1: no GL device");
  EXPECT_EQ(error(self({"chatty-worker"})), "no render worker: it began with 'hello'");
  EXPECT_EQ(error({"/nonexistent/worker"}), "no render worker: it ended with status 127: No such file or directory");
  EXPECT_EQ(error({"sleep", "30"}, "0.5"), "no render worker: it said nothing for 1 s");
}

TEST_F(Sweep, BadInputOfAWorkerIsBadInput) {
  options.worker = self({"dead-worker", "2"});  // as for a --device that does not exist
  EXPECT_EQ(input_error([&] { run(spec("") + "[run.axes]\nn = [1]\n"); }), "no GL device");
}

TEST_F(Sweep, StopsAtAnInterruptAndGoesOnLater) {
  const std::string text = spec("") + "[run.axes]\nn = { from = 1, to = 40, steps = 40 }\n[run.fixed]\nsleep_ms = 30\n";
  std::thread interrupter([&] {
    while (requests().size() < 4)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ::kill(::getpid(), SIGINT);
  });
  const SweepSummary first = run(text);
  interrupter.join();
  EXPECT_TRUE(first.interrupted);
  EXPECT_GE(first.measured, 3U);
  EXPECT_GT(first.left, 0U);
  EXPECT_EQ(first.failed, 0U);
  const SweepSummary second = run(text);
  EXPECT_FALSE(second.interrupted);
  EXPECT_EQ(second.reused, first.measured);
  EXPECT_EQ(second.left, 0U);
  EXPECT_LE(requests().size(), 41U);
}

TEST(WorkerProcess, DiesWithItsOwner) {
  pid_t pid = 0;
  {
    const WorkerProcess process({"sleep", "1000"});
    pid = process.pid();
    EXPECT_TRUE(process.alive());
    EXPECT_EQ(::kill(pid, 0), 0);
  }
  EXPECT_NE(::kill(pid, 0), 0);
}

TEST(WorkerProcess, GivesWholeLinesOnly) {
  WorkerProcess process({"sh", "-c", "printf 'one\\ntw'; sleep 0.1; printf 'o\\nthree'"});
  const auto next = [&] {
    return process.receive(std::chrono::steady_clock::now() + std::chrono::seconds(10), [] { return true; });
  };
  EXPECT_EQ(next().line, "one");
  EXPECT_EQ(next().line, "two");
  const WorkerProcess::Received last = next();
  EXPECT_EQ(last.event, WorkerProcess::Event::ended);
  EXPECT_EQ(last.line, "three");
  EXPECT_EQ(process.end(), "ended with status 0");
}

}  // namespace
}  // namespace pellucid::sweeps
