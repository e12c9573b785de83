// pellucid sweep run and pellucid reference, killed: with the real workers, scenes and metrics.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <filesystem>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/cloudy_ball.hpp"
#include "tests/sandbox/program.hpp"

namespace pellucid::test {
namespace {

using nlohmann::json;

json rows_of(const std::string& store) {
  const Outcome outcome = pellucid({"results", store, "--format", "json"});
  return outcome.status == 0 ? json::parse(outcome.out) : json::array();
}

/// The part of a row that does not depend on when and how often it was measured: parameters, metrics, hashes, where it
/// was rendered.
json deterministic(const json& row) {
  json out;
  for (const auto& [name, value] : row.items()) {
    const bool timed = name.starts_with("frame_ms") || name.ends_with("_s") || name.ends_with("_ms") ||
                       name.ends_with("_bytes") || name.ends_with("_utc");
    const bool of_run =
        name == "fps" || name.ends_with("frames") || name == "timing" || name == "argv" || name == "baseline_drift";
    if (!timed && !of_run) out[name] = value;
  }
  for (const char* name : {"point", "hulls", "rmse", "psnr", "flip_mean", "flip_mean_mask", "scene_hash", "repeat"})
    EXPECT_TRUE(out.contains(name)) << name;
  return out;
}

TEST(KilledSweepCommand, LeavesTheRowsOfOneThatWasNot) {
  const TemporaryFolder folder;
  const std::string scene = write_small_scene(folder).string();
  const std::string spec = write_file(folder / "killed.toml", R"(name = "killed"
metrics = ["rmse", "psnr", "flip"]
timeout_s = 60

[timing]
min_samples = 100
max_samples = 100
max_seconds = 1

[reference]
tolerance = 1e-3

[[run]]
name = "hulls"
techniques = ["sampling_hulls"]
scenes = [")" + scene + R"("]
views = ["front", "side"]
sizes = ["48x36"]

[run.axes]
hulls = [1, 2, 4, 8, 16]
)")
                               .string();
  const std::string killed = (folder / "killed.db").string(), whole = (folder / "whole.db").string();
  auto sweep = [&](const std::string& store) {
    return std::vector<std::string>{"sweep", "run", spec, "--store", store};
  };

  // Three times: while the first point is in work, and a random while after one more row is there.
  std::mt19937 random(2005);
  json before = json::array();
  for (int kill = 0; kill < 3; ++kill) {
    auto command = sweep(killed);
    command.insert(command.begin(), PELLUCID_PROGRAM);
    Background running(command);
    while (kill > 0 && rows_of(killed).size() <= before.size() && running.running())
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 300));
    ASSERT_TRUE(running.running()) << "it was over before it could be killed";
    running.stop(SIGKILL);
    const json stored = rows_of(killed);
    for (const json& row : before)
      EXPECT_NE(std::find(stored.begin(), stored.end(), row), stored.end()) << "a row was lost or has changed";
    before = stored;
  }
  ASSERT_GT(before.size(), 0U);
  ASSERT_LT(before.size(), 10U);
  ASSERT_TRUE(succeeded(pellucid(sweep(killed))));
  ASSERT_TRUE(succeeded(pellucid(sweep(whole))));

  const json rows = rows_of(killed), expected = rows_of(whole);
  ASSERT_EQ(expected.size(), 10U);
  ASSERT_EQ(rows.size(), expected.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    EXPECT_EQ(json::diff(deterministic(rows[i]), deterministic(expected[i])), json::array()) << rows[i].at("repeat");
  for (const json& row : before)
    EXPECT_NE(std::find(rows.begin(), rows.end(), row), rows.end()) << "a row was measured again";
}

TEST(KilledReferenceCommand, GoesOnToThePictureOfOneThatWasNot) {
  const TemporaryFolder folder;
  const std::string scene = write_file(folder / "ball.toml", cloudy_ball(8, 0.5)).string();
  const std::filesystem::path cache = folder / "cache";
  const Setting keeps{.environment = {{"PELLUCID_CACHE", cache.string()}}};
  const auto kept = [&] {
    return std::filesystem::exists(cache / "paths") && !std::filesystem::is_empty(cache / "paths");
  };
  int samples = 24;
  const auto command = [&](const std::string& name) {
    return std::vector<std::string>{"reference", scene,       "--size",
                                    "96x96",     "--samples", std::to_string(samples),
                                    "--json",    "-o",        (folder / name).string()};
  };

  // Something is kept after two seconds for the first time; the faster the machine, the more samples that takes.
  bool stopped = false;
  while (!stopped && samples < 10'000) {
    samples *= 4;
    std::filesystem::remove_all(cache);
    std::filesystem::remove(folder / "killed.exr");
    auto killed = command("killed.exr");
    killed.insert(killed.begin(), PELLUCID_PROGRAM);
    Background running(killed, keeps);
    while (!kept() && running.running())
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    stopped = running.running();
    if (stopped) running.stop(SIGKILL);
  }
  ASSERT_TRUE(stopped) << "it was over before it could be killed";
  EXPECT_FALSE(std::filesystem::exists(folder / "killed.exr"));

  const Outcome resumed = pellucid(command("killed.exr"), keeps);
  const Outcome whole = pellucid(command("whole.exr"), {.environment = {{"PELLUCID_CACHE", "off"}}});
  ASSERT_TRUE(succeeded(resumed));
  ASSERT_TRUE(succeeded(whole));
  EXPECT_GT(json::parse(resumed.out).at("kept_samples"), 0) << "it began anew";
  EXPECT_EQ(json::parse(whole.out).at("kept_samples"), 0);
  EXPECT_EQ(json::parse(resumed.out).at("standard_error_mean"), json::parse(whole.out).at("standard_error_mean"));
  const Outcome compared =
      pellucid({"compare", (folder / "whole.exr").string(), (folder / "killed.exr").string(), "-m", "rmse", "--json"});
  ASSERT_TRUE(succeeded(compared));
  EXPECT_EQ(json::parse(compared.out).at("rmse"), 0.0);
}

}  // namespace
}  // namespace pellucid::test
