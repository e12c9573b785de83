#include "sweeps/store/merge.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "gl/error.hpp"
#include "sweeps/store/store.hpp"

namespace pellucid::sweeps {
namespace {

using nlohmann::json;

constexpr std::size_t kNamed = 5;  ///< conflicts that a message lists

/// Fields in which two rows of the same point differ though they should not: "rmse: 0.1 and 0.2".
std::vector<std::string> differences(const json& a, const json& b) {
  std::set<std::string> fields;
  for (const json* row : {&a, &b}) {
    for (const auto& [field, value] : row->items()) {
      if (!is_circumstance(field)) fields.insert(field);
    }
  }
  std::vector<std::string> result;
  for (const std::string& field : fields) {
    const json in_a = a.contains(field) ? a.at(field) : json();
    const json in_b = b.contains(field) ? b.at(field) : json();
    if (in_a != in_b) result.push_back(fmt::format("{}: {} and {}", field, in_a.dump(), in_b.dump()));
  }
  return result;
}

/// Whether `a` stays rather than `b`: the same whichever comes first.
bool stays(const StoredRow& a, const StoredRow& b, Prefer prefer) {
  if (a.failed != b.failed) return b.failed;
  if (a.done_unix_s != b.done_unix_s) return (a.done_unix_s < b.done_unix_s) == (prefer != Prefer::newest);
  return a.row < b.row;
}

class Merger {
 public:
  Merger(Store& output, Prefer prefer) : output_(output), prefer_(prefer) {
    for (const StoredPlan& plan : output.plans())
      plans_.emplace(plan.name, std::pair(plan, "the store so far"));
    for (const auto& [sweep, sample] : output.all_baselines())
      baselines_.insert(key(sweep, sample));
    for (const RunRecord& run : output.runs())
      runs_.insert(key(run));
  }

  void add(const std::filesystem::path& path) {
    const Store input(path, Access::read);
    ++summary_.stores;
    for (const StoredPlan& plan : input.plans())
      add_plan(plan, path);
    // A store of version 1 has no list of its columns.
    const bool unlisted = input.parameter_names().empty();
    input.each_row([&](const StoredRow& row) {
      if (unlisted) output_.note_columns(row_json(row, path));
      add_row(row, path);
    });
    for (const auto& [sweep, sample] : input.all_baselines()) {
      if (baselines_.insert(key(sweep, sample)).second) output_.put_baseline(sweep, sample);
    }
    for (const RunRecord& run : input.runs()) {
      if (runs_.insert(key(run)).second) output_.put(run);
    }
    output_.copy_columns(input);
  }

  MergeSummary finish() {
    if (!summary_.conflicts.empty() && prefer_ == Prefer::neither) {
      std::string list;
      for (std::size_t i = 0; i < std::min(kNamed, summary_.conflicts.size()); ++i)
        list += "\n  " + summary_.conflicts[i];
      throw InputError(
          fmt::format("{} point{} measured twice with different results; --prefer oldest or newest settles it:{}{}",
                      summary_.conflicts.size(), summary_.conflicts.size() == 1 ? " was" : "s were", list,
                      summary_.conflicts.size() > kNamed ? "\n  …" : ""));
    }
    int rank = 0;  // by name, so that the inputs' order does not show
    for (const auto& [name, plan] : plans_)
      output_.put(plan.first, rank++);
    output_.each_row([&](const StoredRow&) { ++summary_.rows; });
    return summary_;
  }

 private:
  static std::string key(const std::string& sweep, const BaselineSample& b) {
    return fmt::format("{}\n{}\n{}\n{}\n{}\n{}", sweep, b.point, b.unix_s, b.device, b.driver, b.host);
  }
  static std::string key(const RunRecord& run) {
    return fmt::format("{}\n{}\n{}\n{}", run.sweep, run.host, run.started_unix_s, run.shard);
  }

  void add_plan(const StoredPlan& plan, const std::filesystem::path& path) {
    const auto [at, is_new] = plans_.try_emplace(plan.name, std::pair(plan, path.string()));
    if (is_new) return;
    const auto& [known, from] = at->second;
    if (known.spec == plan.spec && known.members == plan.members) return;
    throw InputError(fmt::format(
        "'{}' and {} hold different plans of the sweep {}: {}; merge stores of one spec and one version of the code",
        path.string(), from == "the store so far" ? from : "'" + from + "'", plan.name,
        known.spec == plan.spec ? "the scenes or the code have changed between them" : "the specs differ"));
  }

  static json row_json(const StoredRow& row, const std::filesystem::path& path) {
    json parsed = json::parse(row.row, nullptr, false);
    if (!parsed.is_object())
      throw InputError(fmt::format("store '{}' is damaged: the row of point {} is not JSON", path.string(), row.id));
    return parsed;
  }

  void add_row(const StoredRow& row, const std::filesystem::path& path) {
    const std::optional<StoredRow> known = output_.find(row.id, row.device, row.driver);
    if (!known) {
      output_.put(row);
      ++summary_.added;
      return;
    }
    if (known->row == row.row && known->frame_ms_samples == row.frame_ms_samples) {
      ++summary_.duplicates;
      return;
    }
    const json a = json::parse(known->row, nullptr, false);
    const std::vector<std::string> different = differences(a, row_json(row, path));
    if (known->failed == row.failed && !row.failed && !different.empty()) {
      summary_.conflicts.push_back(fmt::format("point {} ({}) in '{}': {}{}", row.id, row.device, path.string(),
                                               different.front(), different.size() > 1 ? ", …" : ""));
    } else {
      ++summary_.repeats;
    }
    if (stays(row, *known, prefer_)) output_.put(row);
  }

  Store& output_;
  Prefer prefer_;
  MergeSummary summary_;
  std::map<std::string, std::pair<StoredPlan, std::string>> plans_;  // and where each comes from
  std::set<std::string> baselines_, runs_;
};

}  // namespace

bool is_circumstance(const std::string& field) {
  static const std::set<std::string> kFields{"fps",     "frames", "warmup_frames",  "timing",    "clock", "commit",
                                             "dirty",   "argv",   "peak_rss_bytes", "gpu_bytes", "host",  "repeat",
                                             "failure", "status", "started_utc",    "pass_ms",   "shard"};
  if (kFields.contains(field)) return true;
  constexpr std::array<std::string_view, 2> kPrefixes{"frame_ms_", "pass_ms."};
  return std::any_of(kPrefixes.begin(), kPrefixes.end(), [&](auto prefix) { return field.starts_with(prefix); }) ||
         field.ends_with("_s");
}

MergeSummary merge_stores(const std::filesystem::path& output, const std::vector<std::filesystem::path>& inputs,
                          Prefer prefer) {
  std::error_code error;
  for (const std::filesystem::path& input : inputs) {
    if (std::filesystem::equivalent(input, output, error)) {
      throw InputError(
          fmt::format("'{}' is the result and an input too; the result keeps what it holds anyway", output.string()));
    }
    const Store readable(input, Access::read);  // all are checked before anything is written
  }
  const bool made = !std::filesystem::exists(output, error);
  try {
    Store store(output, Access::write);
    MergeSummary summary;
    store.all_or_nothing([&] {
      Merger merger(store, prefer);
      for (const std::filesystem::path& input : inputs)
        merger.add(input);
      summary = merger.finish();
    });
    return summary;
  } catch (...) {
    if (made) {
      for (const char* suffix : {"", "-wal", "-shm", "-journal"})
        std::filesystem::remove(output.string() + suffix, error);
    }
    throw;
  }
}

}  // namespace pellucid::sweeps
