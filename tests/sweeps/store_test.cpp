#include "sweeps/store/store.hpp"

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "gl/error.hpp"
#include "sweeps/spec/provenance.hpp"
#include "sweeps/store/sqlite.hpp"
#include "tests/sweeps/example_store.hpp"
#include "tests/sweeps/fake_known_names.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;
using test::Example;
using test::fill;
using test::input_error;
using test::kSpec;
using test::row_of;
using test::TemporaryFolder;

TEST(Store, ReadsBackWhatWasWritten) {
  const TemporaryFolder folder;
  const Example e;
  fill(folder / "s.db", e);
  const std::vector<json> rows = read_rows(folder / "s.db", true);
  ASSERT_EQ(rows.size(), 2U);  // one point, which stands in two blocks
  EXPECT_EQ(rows[0].at("block"), "a");
  EXPECT_EQ(rows[1].at("block"), "b");
  EXPECT_EQ(rows[0].at("point"), e.plan.points[1].id);
  EXPECT_EQ(rows[0].at("sweep"), "s");
  EXPECT_EQ(rows[0].at("frame_ms_median"), 0.1);
  EXPECT_EQ(rows[0].at("pass_ms").at("back"), 0.05);
  EXPECT_EQ(rows[0].at("frame_ms_samples"), (std::vector<double>{0.1, 0.2, 1.0 / 3}));
  EXPECT_TRUE(rows[0].at("baseline_drift").is_null());
  EXPECT_FALSE(read_rows(folder / "s.db")[0].contains("frame_ms_samples"));

  const Store store(folder / "s.db", Access::read);
  ASSERT_EQ(store.points().size(), 1U);
  EXPECT_EQ(store.points()[0].device, "d");
  EXPECT_EQ(store.points()[0].wall_s, 2.5);
  EXPECT_EQ(store.samples(e.plan.points[1].id).size(), 3U);
  EXPECT_EQ(store.spec_text("s"), kSpec);
  EXPECT_EQ(store.spec_text("t"), std::nullopt);
}

TEST(Store, CountsByBlockInTheSpecsOrder) {
  const TemporaryFolder folder;
  const Example e;
  fill(folder / "s.db", e);
  {
    Store store(folder / "s.db", Access::write);
    store.put_row(e.plan.points[2].id, row_of("failed", 0), {});
  }
  const std::vector<BlockStatus> status = Store(folder / "s.db", Access::read).status();
  ASSERT_EQ(status.size(), 2U);
  EXPECT_EQ(status[0].block, "a");
  EXPECT_EQ(status[0].planned, 2U);
  EXPECT_EQ(status[0].done, 1U);
  EXPECT_EQ(status[0].left(), 1U);
  EXPECT_EQ(status[1].failed, 1U);
  EXPECT_EQ(status[1].left(), 0U);
}

TEST(Store, AChangedPlanHidesOldRowsAndKeepsThem) {
  const TemporaryFolder folder;
  Example e;
  fill(folder / "s.db", e);
  e.known_names.code = "other";
  {
    Store store(folder / "s.db", Access::write);
    store.put_plan(e.spec, make_plan(e.spec, e.known_names));
  }
  EXPECT_TRUE(read_rows(folder / "s.db").empty());
  EXPECT_EQ(Store(folder / "s.db", Access::read).points().size(), 1U);
  {
    Store store(folder / "s.db", Access::write);
    store.put_plan(e.spec, e.plan);  // the shader as it was
  }
  EXPECT_EQ(read_rows(folder / "s.db").size(), 2U);
}

TEST(Store, DriftIsInterpolatedToARowsTime) {
  const TemporaryFolder folder;
  const Example e;
  fill(folder / "s.db", e);  // timed at 150
  const std::string id = e.plan.points[0].id;
  const auto drift = [&] { return read_rows(folder / "s.db")[0].at("baseline_drift").get<double>(); };
  const auto baseline = [&](const std::string& point, double at, double ms) {
    Store(folder / "s.db", Access::write).put_baseline("s", {point, at, ms, {ms}});
  };
  baseline(id, 100, 10);
  EXPECT_DOUBLE_EQ(drift(), 0);
  baseline(id, 200, 12);
  EXPECT_DOUBLE_EQ(drift(), 0.1);
  baseline("another", 300, 50);  // a new baseline point starts a new series
  EXPECT_DOUBLE_EQ(drift(), 0);
}

TEST(Store, AnInfinityBecomesNull) {
  const TemporaryFolder folder;
  const Example e;
  {
    Store store(folder / "s.db", Access::write);
    store.put_plan(e.spec, e.plan);
    json row = row_of("ok", 1);
    row["psnr"] = std::numeric_limits<double>::infinity();
    row["failure"] = "bad text \xff";
    store.put_row(e.plan.points[0].id, row, {});
  }
  EXPECT_TRUE(read_rows(folder / "s.db")[0].at("psnr").is_null());
}

void write_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

TEST(Store, RefusesWhatIsNoStore) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& name, Access access) {
    const std::string path = (folder / name).string();
    std::string message = input_error([&] { Store(path, access); });
    const std::size_t at = message.find(path);
    return at == std::string::npos ? message : message.replace(at, path.size(), "PATH");
  };
  EXPECT_EQ(error("missing.db", Access::read), "store 'PATH' does not exist");
  EXPECT_FALSE(std::filesystem::exists(folder / "missing.db"));
  write_file(folder / "text.db", std::string(5000, 'x'));
  EXPECT_EQ(error("text.db", Access::read), "store 'PATH' is not a Pellucid store");
  EXPECT_EQ(error("text.db", Access::write), "store 'PATH' is not a Pellucid store");
  write_file(folder / "empty.db", "");
  EXPECT_EQ(error("empty.db", Access::read), "store 'PATH' is not a Pellucid store");
  std::filesystem::create_directory(folder / "folder.db");
  EXPECT_EQ(error("folder.db", Access::read), "store 'PATH' is a folder");
  EXPECT_EQ(error("folder.db", Access::write), "store 'PATH' is a folder");

  Database(folder / "foreign.db", Database::Mode::create).run("CREATE TABLE t(x)");
  EXPECT_EQ(error("foreign.db", Access::write), "store 'PATH' is not a Pellucid store");
  EXPECT_EQ(Database(folder / "foreign.db", Database::Mode::read).integer("SELECT count(*) FROM sqlite_master"), 1);

  { const Store store(folder / "newer.db", Access::write); }
  Database(folder / "newer.db", Database::Mode::create).run("PRAGMA user_version = 7");
  EXPECT_EQ(error("newer.db", Access::write),
            "store 'PATH' has schema version 7, and this program reads versions 1 to 2; use the program "
            "that made it, or another store");
}

TEST(Store, NoticesDamage) {
  const TemporaryFolder folder;
  const Example e;
  fill(folder / "s.db", e);
  const auto size = std::filesystem::file_size(folder / "s.db");
  ASSERT_GT(size, 8192U);
  {
    std::fstream file(folder / "s.db", std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(4096);
    file << std::string(size - 4096, '\xff');
  }
  EXPECT_NE(input_error([&] { read_rows(folder / "s.db"); }).find("is damaged: "), std::string::npos);
}

TEST(Store, NoticesARowThatIsNoJson) {
  const TemporaryFolder folder;
  const Example e;
  fill(folder / "s.db", e);
  Database(folder / "s.db", Database::Mode::create).run("UPDATE points SET row = '{\"hulls\": '");
  EXPECT_NE(input_error([&] { read_rows(folder / "s.db"); }).find("is damaged: the row of point"), std::string::npos);
}

TEST(Store, HasOneWriterAndAnyReaders) {
  const TemporaryFolder folder;
  const Example e;
  fill(folder / "s.db", e);
  {
    Store writer(folder / "s.db", Access::write);
    EXPECT_EQ(read_rows(folder / "s.db").size(), 2U);
    try {
      const Store second(folder / "s.db", Access::write);
      ADD_FAILURE() << "two writers";
    } catch (const RuntimeError& error) {
      EXPECT_NE(std::string(error.what()).find("is being written by another sweep"), std::string::npos);
    }
  }
  EXPECT_NO_THROW(Store(folder / "s.db", Access::write));
  EXPECT_FALSE(std::filesystem::exists(folder / "s.db-lock"));
}

/// A store as version 1 had it, of one row.
void write_version_1(const std::filesystem::path& path, const Example& e) {
  fill(path, e);
  Database db(path, Database::Mode::create);
  db.run(
      "DROP VIEW results; DROP TABLE columns; DROP TABLE runs;"
      "CREATE TABLE points_1(id TEXT PRIMARY KEY, failed INTEGER NOT NULL, done_unix_s REAL NOT NULL, row TEXT NOT "
      "NULL, frame_ms BLOB NOT NULL);"
      "INSERT INTO points_1 SELECT id, failed, done_unix_s, row, frame_ms FROM points; DROP TABLE points;"
      "ALTER TABLE points_1 RENAME TO points;"
      "ALTER TABLE baselines DROP COLUMN device; ALTER TABLE baselines DROP COLUMN driver;"
      "ALTER TABLE baselines DROP COLUMN host;"
      "INSERT INTO baselines(sweep, point, unix_s, frame_ms_median, frame_ms) VALUES('s', 'x', 100, 10, x'');"
      "INSERT INTO baselines(sweep, point, unix_s, frame_ms_median, frame_ms) VALUES('s', 'x', 200, 12, x'');"
      "PRAGMA user_version = 1;");
}

TEST(Store, ReadsAStoreOfVersion1AndBringsItUpToDateWhenItWrites) {
  const TemporaryFolder folder;
  const Example e;
  const std::filesystem::path path = folder / "old.db";
  write_version_1(path, e);
  const std::vector<json> before = read_rows(path, true);
  ASSERT_EQ(before.size(), 2U);
  EXPECT_EQ(before[0].at("frame_ms_samples").size(), 3U);
  EXPECT_DOUBLE_EQ(before[0].at("baseline_drift").get<double>(), 0.1);
  EXPECT_EQ(Store(path, Access::read).points().at(0).device, "d");
  EXPECT_EQ(Store(path, Access::read).status().at(0).done, 1U);
  EXPECT_EQ(Database(path, Database::Mode::read).integer("PRAGMA user_version"), 1) << "reading changes nothing";
  { const Store store(path, Access::write); }
  const Database db(path, Database::Mode::read);
  EXPECT_EQ(db.integer("PRAGMA user_version"), 2);
  EXPECT_EQ(db.integer("SELECT hulls FROM results"), 2);
  EXPECT_EQ(read_rows(path, true), before);
}

TEST(Store, KeepsDevicesApart) {
  const TemporaryFolder folder;
  const Example e;
  const std::filesystem::path path = folder / "s.db";
  fill(path, e);
  json other = row_of("ok", 150);
  other["device"] = "another";
  other["frame_ms_median"] = 7;
  {
    Store store(path, Access::write);
    store.put_row(e.plan.points[1].id, other, std::vector<double>{7});
    store.put_baseline("s", {"x", 100, 10, {10}, "d", "v", ""});
    store.put_baseline("s", {"x", 200, 20, {20}, "another", "v", ""});
  }
  const std::vector<json> rows = read_rows(path);
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[0].at("device"), "another");
  EXPECT_EQ(rows[0].at("frame_ms_median"), 7);
  EXPECT_EQ(rows[0].at("baseline_drift"), 0.0) << "of its own device's baseline";
  EXPECT_EQ(rows[1].at("device"), "d");
  const std::vector<BlockStatus> status = Store(path, Access::read).status();
  ASSERT_EQ(status.size(), 4U);
  EXPECT_EQ(status[0].device, "another, v");
  EXPECT_EQ(status[0].done, 1U);
  EXPECT_EQ(status[0].planned, 2U);
  EXPECT_EQ(status[2].device, "d, v");
}

TEST(Store, AFailureBeforeAnyDeviceCountsUntilARowComes) {
  const TemporaryFolder folder;
  const Example e;
  Store store(folder / "s.db", Access::write);
  store.put_plan(e.spec, e.plan);
  const std::string id = e.plan.points[0].id;
  store.put_row(id, {{"status", "failed"}, {"device", ""}, {"driver", ""}}, {});
  ASSERT_EQ(store.points().size(), 1U);
  EXPECT_TRUE(store.points()[0].failed);
  store.put_row(id, row_of("ok", 1), {});
  ASSERT_EQ(store.points().size(), 1U);
  EXPECT_FALSE(store.points()[0].failed);
}

TEST(Store, KeepsSamplesLittleEndian) {
  const TemporaryFolder folder;
  const Example e;
  fill(folder / "s.db", e);
  const Database db(folder / "s.db", Database::Mode::read);
  Statement statement(db, "SELECT hex(frame_ms) FROM points");
  ASSERT_TRUE(statement.step());
  EXPECT_EQ(statement.text(0).substr(0, 16), "9A9999999999B93F");  // 0.1, the least significant byte first
}

TEST(Store, OnASharedFileSystemHasARollbackJournalAndOneUser) {
  const TemporaryFolder folder;
  const Example e;
  ::setenv("PELLUCID_NETWORK_STORES", "1", 1);
  {
    Store store(folder / "s.db", Access::write);
    store.put_plan(e.spec, e.plan);
    store.put_row(e.plan.points[1].id, row_of("ok", 150), {});
    EXPECT_FALSE(std::filesystem::exists(folder / "s.db-wal"));
    EXPECT_FALSE(std::filesystem::exists(folder / "s.db-shm"));
  }
  EXPECT_EQ(read_rows(folder / "s.db").size(), 2U);
  ::setenv("PELLUCID_NETWORK_STORES", "yes", 1);
  EXPECT_NE(input_error([&] { Store(folder / "s.db", Access::write); }).find("neither 0 nor 1"), std::string::npos);
  ::unsetenv("PELLUCID_NETWORK_STORES");
}

TEST(Store, ADeadOwnersLockIsTakenOverAndALivingOnesIsNot) {
  const TemporaryFolder folder;
  const Example e;
  fill(folder / "s.db", e);
  const auto lock = [&](const std::string& owner) { write_file(folder / "s.db-lock", owner); };
  lock(host_name() + " 999999999 12345\n");
  EXPECT_NO_THROW(Store(folder / "s.db", Access::write));
  lock(fmt::format("{} {} 1\n", host_name(), ::getpid()));  // an earlier process of this number
  EXPECT_NO_THROW(Store(folder / "s.db", Access::write));
  lock("elsewhere 12 34\n");
  try {
    const Store store(folder / "s.db", Access::write);
    ADD_FAILURE() << "another machine's sweep may live";
  } catch (const RuntimeError& error) {
    EXPECT_NE(std::string(error.what()).find("process 12 of elsewhere"), std::string::npos) << error.what();
  }
  std::filesystem::remove(folder / "s.db-lock");
}

TEST(Store, NoticesThatItsLockWasTakenAway) {
  const TemporaryFolder folder;
  const Example e;
  Store store(folder / "s.db", Access::write);
  store.put_plan(e.spec, e.plan);
  std::filesystem::remove(folder / "s.db-lock");
  EXPECT_THROW(store.put_row(e.plan.points[1].id, row_of("ok", 150), {}), RuntimeError);
}

TEST(Store, CannotBeMadeWhereNothingCanBeWritten) {
  EXPECT_THROW(Store("/proc/nowhere/s.db", Access::write), RuntimeError);
}

}  // namespace
}  // namespace pellucid::sweeps
