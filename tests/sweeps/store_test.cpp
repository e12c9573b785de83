#include "sweeps/store/store.hpp"

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "sweeps/store/sqlite.hpp"
#include "tests/sweeps/fake_catalogue.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;
using test::FakeCatalogue;
using test::input_error;
using test::TemporaryFolder;

const char* const kSpec =
    "name='s'\n[[run]]\nname='a'\ntechniques=['hulls']\nscenes=['forest']\nbaseline=true\n[run.axes]\nhulls=[1,2]\n"
    "[[run]]\nname='b'\ntechniques=['hulls']\nscenes=['forest']\n[run.axes]\nhulls=[2,3]\n";

struct Example {
  FakeCatalogue catalogue;
  Spec spec = parse_spec(kSpec, "s.toml", catalogue);
  Plan plan = make_plan(spec, catalogue);
};

json row_of(const std::string& status, double timed_unix_s) {
  return {{"status", status},
          {"hulls", 2},
          {"timing", "converged"},
          {"frame_ms_median", 0.1},
          {"timed_unix_s", timed_unix_s},
          {"done_unix_s", timed_unix_s + 1},
          {"device", "d"},
          {"driver", "v"},
          {"commit", "c"},
          {"wall_s", 2.5},
          {"pass_ms", {{"back", 0.05}}}};
}

void fill(const std::filesystem::path& path, const Example& e) {
  Store store(path, Access::write);
  store.put_plan(e.spec, e.plan);
  store.put_row(e.plan.points[1].id, row_of("ok", 150), std::vector<double>{0.1, 0.2, 1.0 / 3});
}

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
  e.catalogue.code = "other";
  {
    Store store(folder / "s.db", Access::write);
    store.put_plan(e.spec, make_plan(e.spec, e.catalogue));
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
            "store 'PATH' has schema version 7, and this program reads version 1; use the program "
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

TEST(Store, CannotBeMadeWhereNothingCanBeWritten) {
  EXPECT_THROW(Store("/proc/nowhere/s.db", Access::write), RuntimeError);
}

}  // namespace
}  // namespace pellucid::sweeps
